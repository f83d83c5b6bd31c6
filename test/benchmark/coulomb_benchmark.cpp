// SPDX-License-Identifier: BSD-3-Clause
// Every solver of the Coulomb problem on every kind of it, from a cold start: time and iterations to
// residuals of 1e-6, or F and the residual reached; what solveCoulomb() makes of it, also to 1e-12; and how
// many of random jams it solves. Times are the least of a few runs, since a busy machine only adds to them.
#include "core/coulomb_problems.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace rbs;
using namespace rbs::coulomb;
using namespace rbs::coulomb_problems;

struct Outcome {
  double ms;
  int iterations;
  double residual;
  bool solved;
  std::string solver;
};

Outcome measure(const std::function<Outcome()>& solve) {
  Outcome best{};
  double total = 0.0;
  for (int run = 0; run < 5 && (run == 0 || total < 500.0); ++run) {
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome = solve();
    outcome.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    total += outcome.ms;
    if (run == 0 || outcome.ms < best.ms) best = outcome;
  }
  return best;
}

void print(const Outcome& outcome) {
  const std::string solver = outcome.solver.empty() ? "" : ", " + outcome.solver;
  if (outcome.solved) {
    std::printf(" %.2g / %d%s |", outcome.ms, outcome.iterations, solver.c_str());
  } else {
    std::printf(" F %.0e |", outcome.residual);
  }
  std::fflush(stdout);
}

Outcome alone(const CoulombProblem& problem, const std::function<Answer(const System&, BodyBlocks&)>& solve) {
  return measure([&] {
    const System system(problem);
    BodyBlocks matrix(system);
    const Answer answer = solve(system, matrix);
    return Outcome{0.0, answer.iterations, answer.residuals.worst(), answer.within(1e-6), ""};
  });
}

Outcome chosen(const CoulombProblem& problem, double tolerance) {
  static const char* const kNames[] = {"warm start", "Gauss–Seidel", "Newton", "interior point", "ADMM"};
  return measure([&] {
    CoulombProblem copy = problem;
    const CoulombResult result = solveCoulomb(copy, tolerance);
    const double residual = std::max(result.signorini, std::max(result.coulomb, result.dissipation));
    return Outcome{0.0, result.iterations, residual, result.converged,
                   kNames[static_cast<int>(result.solver)]};
  });
}

}  // namespace

int main() {
  const std::vector<std::pair<const char*, std::function<Scene()>>> problems = {
      {"stack of 10", [] { return stack(std::vector<double>(10, 1.0)); }},
      {"stack of 30", [] { return stack(std::vector<double>(30, 1.0)); }},
      {"stack of 100", [] { return stack(std::vector<double>(100, 1.0)); }},
      {"1,000 kg on 1 kg",
       [] {
         return stack({1.0, 1e3});
       }},
      {"10⁶ kg on 1 kg",
       [] {
         return stack({1.0, 1e6});
       }},
      {"1 … 10⁴ kg, heaviest on top",
       [] {
         return stack({1.0, 10.0, 100.0, 1e3, 1e4});
       }},
      {"wall of 20 rows", [] { return wall(20, 10); }},
      {"wall of 60 rows", [] { return wall(60, 30); }},
      {"slope, mu (1 − 1e-3)", [] { return slope(0.5 * (1.0 - 1e-3), 0.5); }},
      {"slope, mu (1 + 1e-3)", [] { return slope(0.5 * (1.0 + 1e-3), 0.5); }},
      {"sliding at 5 m/s",
       [] {
         return slope(0.0, 0.5, {5, 0, 0});
       }},
      {"sliding with spin",
       [] {
         return slope(0.0, 0.5, {5, 0, 0}, {0, 0, 10});
       }},
      {"wedge, mu 0.8", [] { return wedge(0.3, 0.8, 2.0); }},
      {"box on 64 points", [] { return grid(8); }},
      {"house of cards, 6 floors", [] { return cardHouse(6); }},
      {"Painlevé's rod", [] { return painleve(1.0, 1.2, 1.0); }},
      {"rubble of 216 at rest, mu 0.5", [] { return rubble(6, 0.5, 1.0, 0.0, 1); }},
      {"rubble, impact, masses 1:10", [] { return rubble(6, 0.5, 10.0, 1.0, 1); }},
      {"rubble, impact, masses 1:10⁴", [] { return rubble(6, 0.5, 1e4, 1.0, 1); }},
      {"rubble, impact, mu 1", [] { return rubble(6, 1.0, 10.0, 1.0, 1); }},
  };
  std::printf(
      "| problem | points | Gauss–Seidel | ADMM | interior point | Newton | chosen, 1e-6 | chosen, 1e-12 "
      "|\n");
  std::printf("|---|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const auto& [name, make] : problems) {
    const CoulombProblem problem = make().problem;
    const Impulses cold = Impulses::Zero(3, problem.points.size());
    std::printf("| %s | %zu |", name, problem.points.size());
    const int sweeps = problem.points.size() < 1000 ? 20000 : 200;
    print(alone(problem, [&](const System& s, BodyBlocks&) { return gaussSeidel(s, 1e-6, sweeps); }));
    print(alone(problem, [&](const System& s, BodyBlocks& m) { return admm(s, m, cold, 1e-6, 1000); }));
    print(alone(problem, [&](const System& s, BodyBlocks& m) { return interiorPoint(s, m, 1e-6, 80); }));
    print(alone(problem, [&](const System& s, BodyBlocks& m) {
      return newton(s, m, {cold, s.residuals(cold)}, 100.0, 1e-6, 60);
    }));
    print(chosen(problem, 1e-6));
    print(chosen(problem, 1e-12));
    std::printf("\n");
  }

  const struct {
    const char* name;
    double mu, ratio, speed;
  } kinds[] = {{"at rest, mu 0.5", 0.5, 1.0, 0.0},       {"impact, mu 0.5, masses 1:10", 0.5, 10.0, 1.0},
               {"at rest, mu 1", 1.0, 1.0, 0.0},         {"impact, mu 1, masses 1:10", 1.0, 10.0, 1.0},
               {"at rest, masses 1:10⁴", 0.5, 1e4, 0.0}, {"impact, masses 1:10⁴", 0.5, 1e4, 1.0}};
  const std::pair<int, unsigned> sizes[] = {{2, 100}, {3, 40}, {4, 20}, {6, 5}};
  std::printf("\n| rubble, to 1e-9 | 8 bodies | 27 | 64 | 216 |\n|---|--:|--:|--:|--:|\n");
  for (const auto& kind : kinds) {
    std::printf("| %s |", kind.name);
    for (const auto& [side, seeds] : sizes) {
      unsigned solved = 0;
      double total = 0.0;
      for (unsigned seed = 1; seed <= seeds; ++seed) {
        CoulombProblem problem = rubble(side, kind.mu, kind.ratio, kind.speed, seed).problem;
        const auto start = std::chrono::steady_clock::now();
        solved += solveCoulomb(problem, 1e-9).converged;
        total += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      }
      std::printf(" %u of %u, %.2g ms |", solved, seeds, total / seeds);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}

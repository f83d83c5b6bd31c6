// SPDX-License-Identifier: BSD-3-Clause
#include "methods/coulomb.h"

#include "methods/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

using namespace coulomb;

namespace {

// A guess may miss the aim by so much, or rounding would unsettle rest.
constexpr double kGuess = 10.0;
// Where less than this is asked, the rounding of double would show in the residuals of a guess.
constexpr double kEveryDigit = 1e-10;

// How fast the points close, m/s; infinite where a guess tells of an impulse, or a velocity is not finite.
double closingWithoutImpulses(const CoulombProblem& problem) {
  double fastest = 0.0;
  for (const CoulombPoint& point : problem.points) {
    if (!point.impulse.isZero(0.0)) return std::numeric_limits<double>::infinity();
    Vec3 u_W = Vec3::Zero();
    if (point.j != kNone) u_W += problem.bodies[point.j].v + problem.bodies[point.j].w.cross(point.r_j);
    if (point.i != kNone) u_W -= problem.bodies[point.i].v + problem.bodies[point.i].w.cross(point.r_i);
    const double u_n = point.frame.col(2).dot(u_W) + point.drive[2];
    if (!std::isfinite(u_n)) return std::numeric_limits<double>::infinity();
    fastest = std::max(fastest, -u_n);
  }
  return fastest;
}

}  // namespace

// Where nothing is expected and nothing closes, nothing happens. Else solvers are tried in this order until
// one passes:
//   the guess as it is
//   a few steps of Newton from the guess, for loads that changed in size only
//   Gauss-Seidel on a few points without loops
//   Newton on small islands, ADMM on large ones
//   the interior point
//   Newton from the best of these
//   the interior point's path by arc length, where that turns back
//   ADMM again, from the best of these
// Where time is over before that, a few sweeps of Gauss-Seidel are still made, so that bodies do not fall
// through. Where it is not Newton's own, an answer that is not yet within the tolerance is given to Newton to
// finish. Couples are known to Newton and Gauss-Seidel alone: there Newton starts once more, softer, and that
// is all. Points that slide in a given direction may allow no solution at all (Painleve 1895), and who gives
// one can do without: then the last resorts are left out, and the interior point as well unless every digit
// is asked.
CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance, double aim) {
  constexpr std::size_t kFewBodies = 4, kSomePoints = 500, kManyPoints = 4000;
  constexpr double kFinish = 1e-6;  // the tolerance of those that Newton finishes
  const double near = std::min(tolerance, kGuess * aim);
  const double closing = closingWithoutImpulses(problem) / problem.speed_unit;
  if (closing <= near) {
    for (CoulombCouple& couple : problem.couples) couple.impulse.setZero();
    return {CoulombSolver::Guess, 0, closing, 0.0, 0.0, true};
  }
  const System system(problem);
  CoulombSolver solver = CoulombSolver::Guess;
  Answer best;
  best.r = system.guess(problem);
  best.residuals = near < kEveryDigit ? system.residuals(best.r)
                                      : system.residuals(best.r, system.relativeVelocitiesAbout(best.r));
  int iterations = 0;
  const auto consider = [&](CoulombSolver of, const Answer& answer) {
    iterations += answer.iterations;
    if (answer.residuals.beyond_rounding >= best.residuals.beyond_rounding) return;
    best = answer;
    solver = of;
  };
  const bool is_warm = !best.r.isZero(0.0);
  if (!best.within(near)) {
    const std::size_t size = system.points().size();
    const bool is_large = size > kManyPoints;
    const bool patient = tolerance < 1e-9;
    const bool slides = std::any_of(system.points().begin(), system.points().end(),
                                    [](const Point& point) { return point.slides; });
    // A little more than asked, so that the same impulses pass as the guess of the next step.
    const double target = 0.1 * aim, rough = std::max(0.1 * tolerance, kFinish);
    BodyBlocks matrix(system);
    const bool turns = !system.couples().empty();
    const Impulses cold = Impulses::Zero(3, best.r.cols());
    const auto finish = [&](CoulombSolver of, const Answer& answer, int cap) {
      consider(of, answer);
      if (!best.within(aim)) consider(of, newton(system, matrix, answer, 1e3, target, cap, tolerance));
    };
    if (is_warm) consider(CoulombSolver::Newton, newton(system, matrix, best, 1e5, target, 5, tolerance));
    if (!best.within(aim) && separable(system)) {
      finish(CoulombSolver::GaussSeidel, gaussSeidel(system, target, 100), 10);
    }
    if (!best.within(aim) && problem.bodies.size() <= kFewBodies) {
      const Answer start{cold, system.residuals(cold)};
      consider(CoulombSolver::Newton, newton(system, matrix, start, 100.0, target, 20, tolerance));
    }
    for (const double stiffness : {10.0, 1.0})
      if (turns && !best.within(tolerance))
        consider(CoulombSolver::Newton, newton(system, matrix, best, stiffness, target, 200, tolerance));
    if (!best.within(tolerance) && is_large && !turns) {
      finish(CoulombSolver::Admm, admm(system, matrix, cold, rough, 100), 10);
    }
    if (!best.within(tolerance) && (patient || !slides) && !turns) {
      finish(CoulombSolver::InteriorPoint, interiorPoint(system, matrix, rough, 80), patient ? 40 : 20);
    }
    if (!best.within(tolerance) && !slides && !turns) {
      consider(CoulombSolver::Newton, newton(system, matrix, best, 10.0, target, 30, tolerance));
    }
    if (!best.within(tolerance) && !slides && !turns && (patient || size <= kSomePoints)) {
      const int cap = !patient ? 150 : is_large ? 100 : 600;
      finish(CoulombSolver::InteriorPoint, followPath(system, matrix, rough, cap), patient ? 40 : 20);
    }
    // Only who asks for every digit waits for the last resort.
    for (int round = 0; round < (is_large ? 1 : 4) && patient && !slides && !turns && !best.within(tolerance);
         ++round) {
      finish(CoulombSolver::Admm, admm(system, matrix, best.r, rough, 500), 20);
    }
  }

  if (!best.within(tolerance) && system.isLate())
    consider(CoulombSolver::GaussSeidel, gaussSeidel(system, tolerance, 10));

  system.store(best.r, problem);
  return {solver,
          iterations,
          best.residuals.signorini,
          best.residuals.coulomb,
          best.residuals.dissipation,
          best.within(tolerance)};
}

}  // namespace rbs

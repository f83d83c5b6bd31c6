// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/coulomb.h"

#include "base/algebra.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

using namespace coulomb;

namespace {

// A warm start may miss the wanted tolerance by so much, or rounding would unsettle rest.
constexpr double kWarmStart = 10.0;
// Residuals from which Newton's method needs no better start, and from which it gets there in time.
constexpr double kNearlySolved = 1e-3, kOnTheWay = 0.1;
// How much more kinetic energy an answer may give to the change of a body's velocity than one that is on the way.
constexpr double kFar = 1e4;
// A warm start that misses by more than this is worth a try of Newton's method with so many points at most: with more, some change
// their state whatever the method does.
constexpr double kWorthATry = 2e-2;
constexpr std::size_t kFewPoints = 8;

// How fast the points close, m/s; infinite where there are joints, a warm start tells of an impulse, or a velocity is not
// finite.
double closingWithoutImpulses(const CoulombProblem& problem) {
  if (!problem.joints.empty()) return std::numeric_limits<double>::infinity();
  double fastest = 0.0;
  for (const CoulombPoint& point : problem.points) {
    if (!point.impulse.isZero(0.0)) return std::numeric_limits<double>::infinity();
    const auto speedOf = [&](Index body, const Vec3& arm) {
      if (body == kNone) return 0.0;
      const Vec3 n_W = point.frame.col(2), &w = problem.bodies[body].w;
      return n_W.dot(problem.bodies[body].v + w.cross(arm)) -
             momentAbout(point.axis_W, arm, n_W) * point.axis_W.dot(w);
    };
    const double u_n = speedOf(point.j, point.r_j) - speedOf(point.i, point.r_i) + point.bias[2];
    if (!std::isfinite(u_n)) return std::numeric_limits<double>::infinity();
    fastest = std::max(fastest, -u_n);
  }
  return fastest;
}

// Coulomb's law may have several answers, and where the one that continues the last forces ends (a body that is pushed over a floor
// loses one of its points) it may leave only one that is far away: impulses that grow against each other until they have
// turned the body about the gap between floor and pusher. By Gauss' principle of least constraint the answer counts whose change of
// velocities, M^-1 J^T r, has the least kinetic energy. Where a warm start has led to one that is on the way, none is taken that
// changes the velocity of a body by a hundred times as much as that does, or as the unit of speed. Bodies are asked one by one: of the
// energy of all, what a light one takes is a small part.
bool isFar(const System& system, const Impulses& r, const Impulses& near) {
  Velocities far = Velocities::Zero(6, system.free().cols()), close = far;
  system.push(r, far);
  system.push(near, close);
  for (std::size_t i = 0; i < system.bodies(); ++i)
    if (far.col(i).squaredNorm() > kFar * std::max(close.col(i).squaredNorm(), system.massOf(i))) return true;
  return false;
}

// A problem, and the best answer to it so far.
struct Case {
  const System& system;
  BodyBlocks& matrix;
  double tolerance, wanted, needed;
  Answer best;
  bool is_warm = best.r != system.noImpulses();  // the warm start tells something
  bool slips = false;                            // somewhere the direction is prescribed
  bool is_frictionless = isFrictionless(system);
  std::size_t size = system.columns() - system.torques().size();
  bool is_large = size > 4000;
  bool wants_every_digit = tolerance < 1e-9;
  // A little more than asked, so that the same impulses pass as the warm start of the next step.
  double target = 0.1 * wanted;
  // For those that Newton's method finishes: `rough` for the first interior point, `fine` for the others.
  double fine = std::max(0.1 * tolerance, 1e-6), rough = std::max(fine, 1e-4);

  Answer cold() const {
    const Impulses zero = system.noImpulses();
    return {zero, system.residuals(zero)};
  }
};

struct Attempt {
  CoulombSolver solver;
  Answer (*solve)(const Case&, double tolerance, int cap);
  bool (*applies)(const Case&);
  double Case::*enough;     // the residual from which it is not made
  double Case::*tolerance;  // of the solver
  int cap;                  // of its iterations
  int finish;               // iterations of Newton's method that finish it
  int rounds = 1;
};

// Newton's method from a start, with the stiffness of a point there. Without friction it is `quadratic`, which cannot get stuck
// and has its own stiffness.
Answer newtonFrom(const Answer& start, double stiffness, const Case& at, double tolerance, int cap) {
  return at.is_frictionless ? quadratic(at.system, at.matrix, start, tolerance, cap, at.tolerance)
                            : newton(at.system, at.matrix, start, stiffness, tolerance, cap, at.tolerance);
}

Answer newtonFromGuess(const Case& at, double tolerance, int cap) {
  return newtonFrom(at.best, 1e5, at, tolerance, cap);
}
Answer newtonFromRest(const Case& at, double tolerance, int cap) {
  return newtonFrom(at.cold(), 100.0, at, tolerance, cap);
}
Answer newtonFromBest(const Case& at, double tolerance, int cap) {
  return newtonFrom(at.best, 10.0, at, tolerance, cap);
}
Answer sweeps(const Case& at, double tolerance, int cap) {
  return gaussSeidel(at.system, tolerance, cap);
}
Answer interior(const Case& at, double tolerance, int cap) {
  return interiorPoint(at.system, at.matrix, tolerance, cap);
}
Answer interiorFromBest(const Case& at, double tolerance, int cap) {
  return interiorPoint(at.system, at.matrix, at.best, tolerance, cap);
}
Answer path(const Case& at, double tolerance, int cap) {
  return followPath(at.system, at.matrix, tolerance, cap);
}
Answer admmFromRest(const Case& at, double tolerance, int cap) {
  return admm(at.system, at.matrix, at.system.noImpulses(), tolerance, cap);
}
Answer admmFromBest(const Case& at, double tolerance, int cap) {
  return admm(at.system, at.matrix, at.best.r, tolerance, cap);
}

// Points that slide in a prescribed direction may allow no solution at all (Painleve 1895), and who
// prescribes one can do without: then the last resorts are left out, and the interior point as well unless
// every digit is asked.
constexpr Attempt kAttempts[] = {
    // A convex problem. Where many redundant points close at once, the interior point finds out sooner which of them push.
    {CoulombSolver::Newton, newtonFromGuess, [](const Case& at) { return at.is_frictionless && at.is_warm; },
     &Case::wanted, &Case::target, 50, 0},
    {CoulombSolver::Newton, newtonFromGuess, [](const Case& at) { return at.is_frictionless && !at.is_warm; },
     &Case::wanted, &Case::target, 10, 0},
    // Loads that changed in size only.
    {CoulombSolver::Newton, newtonFromGuess,
     [](const Case& at) {
       return !at.is_frictionless && at.is_warm && (at.size <= kFewPoints || at.best.within(kWorthATry));
     },
     &Case::wanted, &Case::target, 8, 0},
    {CoulombSolver::GaussSeidel, sweeps, [](const Case& at) { return separable(at.system); }, &Case::wanted,
     &Case::target, 100, 10},
    {CoulombSolver::Newton, newtonFromRest, [](const Case& at) { return at.system.free().cols() <= 4; },
     &Case::wanted, &Case::target, 20, 0},
    {CoulombSolver::Admm, admmFromRest, [](const Case& at) { return at.is_large; }, &Case::tolerance,
     &Case::fine, 100, 10},
    {CoulombSolver::InteriorPoint, interiorFromBest,
     [](const Case& at) { return !at.is_frictionless && (at.wants_every_digit || !at.slips); },
     &Case::tolerance, &Case::rough, 30, 20},
    // In heaps of a thousand points the interior point gets stuck at about 1e-2. The proximal steps are slow but sure.
    {CoulombSolver::Newton, newtonFromBest,
     [](const Case& at) { return !at.is_frictionless && !at.slips && at.best.within(kOnTheWay); },
     &Case::needed, &Case::target, 150, 0},
    {CoulombSolver::InteriorPoint, interior, [](const Case& at) { return at.wants_every_digit; },
     &Case::tolerance, &Case::fine, 80, 40},
    {CoulombSolver::InteriorPoint, interior,
     [](const Case& at) { return !at.wants_every_digit && !at.slips; }, &Case::tolerance, &Case::fine, 80,
     20},
    // The central path would begin anew.
    {CoulombSolver::Newton, newtonFromBest,
     [](const Case& at) {
       return !at.slips && (at.best.within(kNearlySolved) || at.system.columns() > at.system.points().size());
     },
     &Case::needed, &Case::target, 400, 0},
    // The central path may turn back where the interior point gets stuck.
    {CoulombSolver::InteriorPoint, path,
     [](const Case& at) { return !at.wants_every_digit && !at.slips && at.size <= 500; }, &Case::needed,
     &Case::fine, 150, 20},
    {CoulombSolver::InteriorPoint, path,
     [](const Case& at) { return at.wants_every_digit && !at.slips && at.is_large; }, &Case::needed,
     &Case::fine, 100, 40},
    {CoulombSolver::InteriorPoint, path,
     [](const Case& at) { return at.wants_every_digit && !at.slips && !at.is_large; }, &Case::needed,
     &Case::fine, 600, 40},
    {CoulombSolver::Admm, admmFromBest,
     [](const Case& at) { return at.wants_every_digit && !at.slips && at.is_large; }, &Case::needed,
     &Case::fine, 500, 20},
    {CoulombSolver::Admm, admmFromBest,
     [](const Case& at) { return at.wants_every_digit && !at.slips && !at.is_large; }, &Case::needed,
     &Case::fine, 500, 20, 4},
    // Bodies are not to fall through, even where time is over.
    {CoulombSolver::GaussSeidel, sweeps, [](const Case& at) { return at.system.isBudgetSpent(); },
     &Case::tolerance, &Case::tolerance, 10, 0},
};

}  // namespace

CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance, double wanted, double needed) {
  const double near = std::min(tolerance, kWarmStart * wanted);
  const double closing = closingWithoutImpulses(problem) / problem.speed_unit;
  if (closing <= near) {
    for (TorqueConstraint& torque : problem.torques) torque.impulse.setZero();
    return {CoulombSolver::WarmStart, 0, closing, 0.0, 0.0, true};
  }
  const System system(problem);
  const Impulses start = system.warmStart(problem);
  const Impulses velocity =
      near < kEveryDigit ? system.relativeVelocities(start) : system.relativeVelocitiesAbout(start);
  CoulombResult result{CoulombSolver::WarmStart, 0, 0.0, 0.0, 0.0, false};
  Answer best{start, system.residuals(start, velocity, near), 0};
  if (!best.within(near)) {
    BodyBlocks matrix(system);
    Case at{system, matrix, tolerance, wanted, needed, std::move(best)};
    at.slips = std::any_of(system.points().begin(), system.points().end(),
                           [](const Point& point) { return point.sliding.slips; });
    const auto consider = [&](CoulombSolver solver, const Answer& answer) {
      result.iterations += answer.iterations;
      if (answer.residuals.beyond_rounding >= at.best.residuals.beyond_rounding) return;
      if (at.is_warm && at.best.within(kOnTheWay) && isFar(system, answer.r, at.best.r)) return;
      at.best = answer;
      result.solver = solver;
    };
    for (const Attempt& attempt : kAttempts) {
      for (int round = 0; round < attempt.rounds; ++round) {
        if (at.best.within(at.*attempt.enough) || !attempt.applies(at)) break;
        const Answer answer = attempt.solve(at, at.*attempt.tolerance, attempt.cap);
        consider(attempt.solver, answer);
        if (attempt.finish > 0 && !at.best.within(wanted))
          consider(attempt.solver, newtonFrom(answer, 1e3, at, at.target, attempt.finish));
      }
    }
    best = std::move(at.best);
  }
  system.store(best.r, problem);
  result.signorini = best.residuals.signorini;
  result.coulomb = best.residuals.coulomb;
  result.dissipation = best.residuals.dissipation;
  result.converged = best.within(needed);
  return result;
}

}  // namespace rbs

#include "methods/coulomb.h"

#include "methods/coulomb_solvers.h"

#include <algorithm>

namespace rbs {

using namespace coulomb;

// Solvers are tried in this order until one passes.
//   the guess as it is
//   a few steps of Newton from the guess, for loads that changed in size only
//   Gauss-Seidel on a few points without loops
//   Newton on small islands
//   the interior point
// What the last three leave is finished by Newton.
CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance) {
  constexpr std::size_t kSmall = 64;  // points
  constexpr double kFinish = 1e-6;    // where the interior point hands over
  const System system(problem);
  CoulombSolver solver = CoulombSolver::Guess;
  Answer best;
  best.r = system.guess(problem);
  best.residuals = system.residuals(best.r);
  int iterations = 0;
  const auto consider = [&](CoulombSolver of, const Answer& answer) {
    iterations += answer.iterations;
    if (answer.residuals.beyond_rounding >= best.residuals.beyond_rounding) return;
    best = answer;
    solver = of;
  };
  const bool is_warm = !best.r.isZero(0.0);
  if (!best.within(tolerance)) {
    BodyBlocks matrix(system);
    const Impulses cold = Impulses::Zero(3, system.points().size());
    if (is_warm) consider(CoulombSolver::Newton, newton(system, matrix, best.r, 1e5, tolerance, 8));
    if (!best.within(tolerance) && separable(system)) {
      consider(CoulombSolver::GaussSeidel, gaussSeidel(system, tolerance, 100));
    }
    if (!best.within(tolerance) && system.points().size() <= kSmall) {
      consider(CoulombSolver::Newton, newton(system, matrix, cold, 100.0, tolerance, 20));
    }
    if (!best.within(tolerance)) {
      consider(CoulombSolver::InteriorPoint, interiorPoint(system, matrix, std::max(tolerance, kFinish), 80));
    }
    if (!best.within(tolerance)) consider(solver, newton(system, matrix, best.r, 1e4, tolerance, 40));
  }

  system.store(best.r, problem);
  return {solver,
          iterations,
          best.residuals.signorini,
          best.residuals.coulomb,
          best.residuals.dissipation,
          best.within(tolerance)};
}

}  // namespace rbs

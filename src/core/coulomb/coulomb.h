// SPDX-License-Identifier: BSD-3-Clause
// The solvers of the Coulomb problem of an island, tried in turn.
#pragma once

#include "coulomb/coulomb_problem.h"

namespace rbs {

enum class CoulombSolver { WarmStart, GaussSeidel, Newton, InteriorPoint, Admm };

struct CoulombResult {
  CoulombSolver solver;  ///< whose impulses these are
  int iterations;  ///< sweeps, or factorisations, or steps of ADMM, of all solvers tried; 0: the warm start passed
  /// How far the answer is from the laws of coulomb_problem.h, the worst over points, torques and joints, in impulse
  /// and in velocity, as a fraction of their units. Measured on the impulses alone: velocities are recomputed
  /// from them.
  double signorini, coulomb, dissipation;
  /// All three are within what is needed, once each point is forgiven the rounding of its velocity: a light
  /// body under a heavy one feels the last digit of the impulses it stands on.
  bool converged;
};

/// Finds impulses and velocities. The solver is chosen by the numbers of bodies and points and by the
/// residuals reached, never by time. Velocities are those of the impulses returned, also where nothing
/// converged: then it is the iterate with the smallest residuals.
/// @param tolerance of the residuals, a fraction of the units, > 0
/// @param wanted a smaller tolerance, for which only a few iterations more are made
/// @param needed a larger tolerance: within it the answer has converged, and the last resorts, which take ten times as long,
/// are not tried
CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance, double wanted, double needed);
inline CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance, double wanted) {
  return solveCoulomb(problem, tolerance, wanted, tolerance);
}
inline CoulombResult solveCoulomb(CoulombProblem& problem, double tolerance) {
  return solveCoulomb(problem, tolerance, tolerance);
}

}  // namespace rbs

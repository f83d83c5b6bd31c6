// SPDX-License-Identifier: BSD-3-Clause
// The solvers of the Coulomb problem, each from a start to the best impulses it finds. All of them but `quadratic` solve
// problems with torques and with prescribed slip, and all solve those with joints.
#pragma once

#include "coulomb/body_blocks.h"
#include "coulomb/coulomb_system.h"

namespace rbs::coulomb {

/// A tolerance below which the rounding of double shows: in the residuals of a warm start, and in Newton's steps, which it cuts
/// short while they still find the answer.
inline constexpr double kEveryDigit = 1e-10;

/// Impulses with what they leave, and what it took to find them.
struct Answer {
  Impulses r;
  Residuals residuals;
  int iterations = 0;
  bool within(double tolerance) const { return residuals.beyond_rounding <= tolerance; }
};

/// Whether Gauss-Seidel may answer: a few points that tie the bodies to each other without loops, so that
/// their impulses are unique and their order does not matter.
bool separable(const System& system);

/// Gauss-Seidel with the exact solution of each point in turn, from zero. Iterations are sweeps.
Answer gaussSeidel(const System& system, double tolerance, int cap);

/// Augmented Lagrangian, semismooth Newton. Iterations are factorisations.
/// @param stiffness of a point at the start, in units of the mass it feels, 1/response
/// @param enough a larger tolerance, for which slow rounds are not gone on with
Answer newton(const System& system, BodyBlocks& matrix, const Answer& start, double stiffness,
              double tolerance, int cap, double enough = 0.0);

/// Whether there is neither friction nor what resists turning, so that `quadratic` may answer.
bool isFrictionless(const System& system);

/// Augmented Lagrangian of a problem without friction. Iterations are factorisations.
/// @param enough as in newton()
Answer quadratic(const System& system, BodyBlocks& matrix, const Answer& start, double tolerance, int cap,
                 double enough = 0.0);

/// Interior point. Iterations are factorisations. Meant for tolerances of 1e-6 and more: beyond, `newton` is to finish.
Answer interiorPoint(const System& system, BodyBlocks& matrix, double tolerance, int cap);
/// The same from near a guess. It takes a third to a half fewer iterations where the guess is nearly right.
Answer interiorPoint(const System& system, BodyBlocks& matrix, const Answer& guess, double tolerance,
                     int cap);

/// The interior point's path by its arc length, slower and through more. Iterations are factorisations.
Answer followPath(const System& system, BodyBlocks& matrix, double tolerance, int cap);

/// Alternating direction method of multipliers. Iterations are steps, one solution of linear equations each.
Answer admm(const System& system, BodyBlocks& matrix, const Impulses& start, double tolerance, int cap);

}  // namespace rbs::coulomb

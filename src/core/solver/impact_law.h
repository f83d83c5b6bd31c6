// SPDX-License-Identifier: BSD-3-Clause
// The impact of two bodies: what an instant of contact does to their velocities.
#pragma once

#include "narrowphase/manifold.h"
#include "state/bodies.h"

#include <array>

namespace rbs {

/// One side of an impact: where the body is, how it moves, and what resists.
struct ImpactSide {
  Vec3 p_WB;
  Twist twist;  ///< changed by collideBodies()
  double inv_mass = 0.0;
  Mat3 inv_inertia_W = Mat3::Zero();
  /// Of revolution, of length 1; it counts where the other side does not move. Zero: none.
  Vec3 axis_W = Vec3::Zero();
};

/// What the two bodies of an impact resist.
struct ImpactLaw {
  double friction, restitution;
  /// The length R of the pair, m, and its coefficients of rolling and torsional resistance (rolling.h); 0: none.
  double radius = 0.0, roll = 0.0, spin = 0.0;
};

/// Largest speed at which a point of the manifold closes, m/s; 0 when none does.
double closingSpeed(const ImpactSide& a, const ImpactSide& b, const Manifold& manifold);

/// Changes both twists by the impulses of the impact.
///
/// Law: Newton's restitution (each closing point leaves at e times the speed at which it came) with Coulomb
/// friction, on the exact circular cone, acting against the sliding that is left at the end of the impact. What resists
/// rolling and spinning acts in the same way against the turning that is left, up to its share of the normal impulse.
/// Where that would create energy, which Newton's law can do in eccentric impacts with friction, e is
/// lowered to the largest value that does not (e = 0 never does).
///
/// Returns the impulses on b, in W, N s, by point of the manifold.
std::array<Vec3, Manifold::kPoints> collideBodies(ImpactSide& a, ImpactSide& b, const Manifold& manifold,
                                                  const ImpactLaw& law);

}  // namespace rbs

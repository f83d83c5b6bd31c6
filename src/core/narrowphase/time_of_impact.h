// SPDX-License-Identifier: BSD-3-Clause
// Time-of-impact queries (continuous collision detection): when two moving shapes first touch.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <optional>

namespace rbs {

/// A motion in closed form: p(t) = p + v s + a s²/2 and q(t) = exp(w s) q, with s = t - t0.
struct Motion {
  double t0 = 0.0;
  Pose pose;                ///< at t0
  Twist twist;              ///< at t0; w_WB stays constant
  Vec3 a_W = Vec3::Zero();  ///< constant acceleration

  Pose at(double t) const;
  Vec3 velocityAt(double t) const { return twist.v_WB + (t - t0) * a_W; }
};

/// The first time in [from, to] at which A and B touch while approaching each other. It is not later than
/// the truth by more than rounding, nor earlier by more than it takes to close 1e-14 of the smaller length,
/// or what rounding leaves of the gap (only a pair that turns through thousands of radians on the way may be
/// answered with an earlier time, while still apart). A pair that touches or overlaps at `from` (within 1e-12
/// of the smaller length) and approaches, or rests and is pressed together, is found at `from`; one that
/// separates is not found until it comes back. Empty when there is none, and for two planes. Adds the
/// number of closest-point queries to `looks`, where it is given; closed forms need none.
std::optional<double> timeOfImpact(const Shape& a, const Motion& motion_a, const Shape& b,
                                   const Motion& motion_b, double from, double to, int* looks = nullptr);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// When a point on a parabola is near something: times of impact that are roots of polynomials.
#pragma once

#include "rigid_body_sim/types.h"

#include <optional>

namespace rbs {

/// A path under constant acceleration.
struct Parabola {
  Vec3 p, v, a;

  Vec3 at(double s) const { return p + s * (v + 0.5 * s * a); }
  Vec3 velocityAt(double s) const { return v + s * a; }
};

/// The first s > 0 at which q0 + q1 s + q2 s²/2 falls to zero, for q0 >= 0.
std::optional<double> firstFall(double q0, double q1, double q2);

/// The first s in [0, horizon] at which the path comes within `radius` (m, > 0) of the box of these half
/// extents (m, >= 0) about the origin, to rounding. A path that starts within `radius` + `margin` (`touches`)
/// must first separate and come back, or turn round before it separates and come nearer by more than `margin`
/// (m, > 0). All points within the box count as equally near.
std::optional<double> firstWithin(double radius, const Vec3& half, const Parabola& path, bool touches,
                                  double margin, double horizon);

}  // namespace rbs

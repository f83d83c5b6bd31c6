// SPDX-License-Identifier: BSD-3-Clause
// A rigid body that no torque acts on, after any length of time, in closed form.
#pragma once

#include "dynamics/inertia.h"

namespace rbs {

struct FreeTurn {
  Quat q_B0B = Quat::Identity();  ///< from the body frame B at the end to the body frame B0 at the start
  Vec3 l_B = Vec3::Zero();        ///< angular momentum in B at the end, kg m²/s
};

/// What `dt` seconds make of a body with angular momentum l_B0 (in B0, not 0) and moments above 0. Exact to
/// rounding: to a few epsilon of the angle turned through. The cost grows as the logarithm of that angle, up
/// to a turn, and not beyond.
FreeTurn turnFreely(const Vec3& l_B0, const Inertia& inertia, double dt);

/// How fast a body turns at most, and how fast its angular velocity changes.
struct SpinBounds {
  double w = 0.0;       ///< |w|, rad/s
  double change = 0.0;  ///< |dw/dt|, rad/s²
};

/// For all times, of a body without torque that has the angular velocity w_B (in B, rad/s) at some time. Each
/// component of w takes its bound at some time.
SpinBounds spinBoundsOf(const Vec3& w_B, const Inertia& inertia);

}  // namespace rbs

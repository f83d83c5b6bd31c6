// SPDX-License-Identifier: BSD-3-Clause
// The motion of a body that nothing touches, in closed form.
#pragma once

#include "dynamics/free_top.h"
#include "rigid_body_sim/types.h"

#include <utility>

namespace rbs {

/// p(t) = p + v s + a s²/2 with s = t - t0, and a rotation without torque: about a constant axis,
/// q(t) = exp(w s) q, or that of a free top.
struct Motion {
  double t0 = 0.0;
  Pose pose;                     ///< at t0
  Twist twist;                   ///< at t0
  Vec3 a_W = Vec3::Zero();       ///< constant acceleration
  const Inertia* top = nullptr;  ///< of a body whose angular velocity changes by itself; null: it is constant

  std::pair<Pose, Twist> stateAt(double t) const;
  Pose at(double t) const { return t == t0 ? pose : stateAt(t).first; }
  Twist twistAt(double t) const { return stateAt(t).second; }
  /// How fast it turns at most, at any time.
  SpinBounds spinBounds() const;

  /// Straight from one pose to another, at constant velocities; t1 > t0. The turn is the shorter one.
  static Motion between(double t0, const Pose& from, double t1, const Pose& to);
};

}  // namespace rbs

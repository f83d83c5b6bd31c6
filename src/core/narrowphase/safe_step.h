// SPDX-License-Identifier: BSD-3-Clause
// Lower bound of the time that two moving shapes stay separated (conservative advancement).
#pragma once

#include "dynamics/motion.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

/// A moving shape at one time. It refers to the shape and the motion that it is made of.
struct MovingShape {
  MovingShape(const Shape& moved, const Motion& along, double time);

  const Shape& shape;
  const Motion& motion;
  double t;
  Pose X_WB;
  Mat3 R_WB;
  Vec3 v_W, a_W, w_W;
  SpinBounds most;  ///< of its angular velocity, at any time
};

/// Separations along a direction that classify a pair, m.
struct Levels {
  double closed;  ///< at most this: the pair is in contact
  double free;    ///< above this: a pair that touched has separated
  double floor;   ///< least separation of a pair that touches until it has separated; < 0
};

/// Time, s, up to `horizon`, during which B certainly stays separated from A along a direction that starts as
/// `n_W` (unit, from A to B) and turns with `turn_W`, rad/s, until little or nothing of that separation is
/// left. If one is a plane, the direction is normal to it and turns with it. A pair that `touches` may come
/// as near as levels.floor until it has separated; its time ends where it turns round. 0 where n_W does not
/// separate the pair by more than levels.closed.
double timeApart(const MovingShape& a, const MovingShape& b, const Vec3& n_W, const Vec3& turn_W,
                 bool touches, const Levels& levels, double horizon);

}  // namespace rbs

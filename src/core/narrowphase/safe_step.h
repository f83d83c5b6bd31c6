// SPDX-License-Identifier: BSD-3-Clause
// How long two moving shapes certainly stay apart.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

namespace rbs {

/// A moving shape at one time. Its acceleration and its angular velocity stay what they are.
struct Mover {
  const Shape& shape;
  Mat3 R_WB;
  Vec3 p_W, v_W, a_W, w_W;
};

/// Separations along a direction, m, that tell how a pair stands.
struct Levels {
  double closed;  ///< at most this: has closed
  double free;    ///< above this, a pair that touched has come free
  double floor;   ///< how near a pair that touches may come while it is not free; < 0
};

/// Seconds, up to `horizon`, during which B certainly stays apart from A along a direction that starts as
/// `n_W` (unit, from A to B) and turns with `turn_W`, rad/s, until little or nothing of that separation is
/// left. If one is a plane, the direction is normal to it and turns with it. A pair that `touches` may come
/// as near as levels.floor until it is free; its time ends where it turns round. 0 where n_W does not
/// separate the pair by more than levels.closed.
double timeApart(const Mover& a, const Mover& b, const Vec3& n_W, const Vec3& turn_W, bool touches,
                 const Levels& levels, double horizon);

}  // namespace rbs

// How long two moving shapes certainly stay apart.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <optional>

namespace rbs {

/// A moving shape at one time. Its acceleration and its angular velocity stay what they are.
struct Mover {
  const Shape& shape;
  Mat3 R_WB;
  Vec3 p_W, v_W, a_W, w_W;
};

/// The first s > 0 at which q0 + q1 s + q2 s²/2 falls to zero, for q0 >= 0.
std::optional<double> firstFall(double q0, double q1, double q2);

/// Seconds, up to `horizon`, during which B does not come nearer to A than -slack along a direction that
/// starts as `n_W` (unit, from A to B). `separation` is their gap along n_W now, + slack > 0. If one is a
/// plane, n_W is normal to it.
double safeStep(const Mover& a, const Mover& b, const Vec3& n_W, double separation, double slack,
                double horizon);

}  // namespace rbs

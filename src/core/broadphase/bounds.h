// Where a body can be during a part of a step: bounds for the broad phase.
#pragma once

#include "context.h"

namespace rbs {

/// Bounds of body i from its present state over the next dt seconds, with a skin of 1 % of its length
/// so that contacts that come and go by rounding stay in the list.
Aabb sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt);

/// The same as an interval on the axis d = (1, 1, 1)/sqrt(3). It takes the exact reach of the shape
/// along d, so it is tighter than the projection of the bounds.
struct Interval {
  double lo, hi;
};
Interval diagonalInterval(const Bodies& bodies, const Load& load, Index i, double dt);

}  // namespace rbs

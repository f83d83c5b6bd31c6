// Where a body can be during a part of a step: bounds for the broad phase.
#pragma once

#include "context.h"

namespace rbs {

/// Bounds of body i from its present state over the next dt seconds, with a skin of 1 % of its length
/// so that contacts that come and go by rounding stay in the list.
Aabb sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt);

/// The same as an interval on the axis d = (1, 1, 1)/sqrt(3). For a sphere of radius R it is d.p -+ R,
/// for a box of half extents h it is d.p -+ sum_k h_k |d.e_k| with e_k its edges' directions: both are
/// tighter than the projection of the bounds.
struct Interval {
  double lo, hi;
};
Interval diagonalInterval(const Bodies& bodies, const Load& load, Index i, double dt);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Where a body can be during a part of a step: bounds for the broad phase.
#pragma once

#include "context.h"

namespace rbs {

/// Bounds of body i from its present state over the next dt seconds, with a skin of 1 % of its length
/// so that contacts that come and go by rounding stay in the list. Along each axis the exact reach of the
/// shape counts, so that the interval along d is tighter than the projection of the others.
Bounds sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt);

}  // namespace rbs

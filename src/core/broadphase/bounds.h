// SPDX-License-Identifier: BSD-3-Clause
// Swept bounds for the broad phase: the space that a body can reach during a part of a step.
#pragma once

#include "state/context.h"

namespace rbs {

/// Bounds of body i from its present state over the next dt seconds, with a margin of 1 % of its length,
/// so that contacts that come and go by rounding stay in the list. Along each axis the exact extent of the
/// shape is used, so the interval along d is tighter than the projection of the other intervals.
Bounds sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt);

}  // namespace rbs

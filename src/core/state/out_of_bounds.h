// SPDX-License-Identifier: BSD-3-Clause
// Out-of-bounds bodies: their state is not finite, or beyond the limits of an edit.
#pragma once

#include "state/context.h"

namespace rbs {

/// Whether a body's state is within the limits of an edit. A saved state beyond them could not be read.
bool withinLimits(const Pose& pose, const Twist& twist);
/// Restores the state of a body at the start of the step and freezes it, with a warning.
void freeze(Context& context, Index i, const Pose& before, const Twist& twist_before);

}  // namespace rbs

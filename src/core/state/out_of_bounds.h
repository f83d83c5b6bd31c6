// SPDX-License-Identifier: BSD-3-Clause
// Bodies out of bounds: their state is not finite, or beyond the limits of an edit.
#pragma once

#include "state/context.h"

namespace rbs {

/// Whether a body's state is within the limits of an edit. A saved state beyond them could not be read.
bool withinLimits(const Pose& pose, const Twist& twist);
/// Brings a body back within the limits, with a warning: one that is only too fast is slowed down to them.
/// Any other gets back its state at the start of the step, and is frozen.
void bringBack(Context& context, Index i, const Pose& before, const Twist& twist_before);

}  // namespace rbs

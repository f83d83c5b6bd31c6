// SPDX-License-Identifier: BSD-3-Clause
// Bodies whose state is no longer finite, or beyond what an edit may ask for.
#pragma once

#include "context.h"

namespace rbs {

/// Whether a body's state is within what an edit may ask for: beyond it a body is lost, and a saved state
/// could not be read.
bool withinLimits(const Pose& pose, const Twist& twist);
/// Puts a body back to where it was at the start of the step and makes it static, with a warning.
void freeze(Context& context, Index i, const Pose& before, const Twist& twist_before);

}  // namespace rbs

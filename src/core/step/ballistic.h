// SPDX-License-Identifier: BSD-3-Clause
// Ballistic bodies: they feel gravity alone and can collide with nothing.
#pragma once

#include "state/context.h"

namespace rbs::ballistic {

Need need(const SceneAnalysis& analysis);
/// Moves them over the step, in closed form. Orientations are integrated where the angular velocity is not
/// constant.
void run(Context& context);

}  // namespace rbs::ballistic

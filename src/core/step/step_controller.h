// SPDX-License-Identifier: BSD-3-Clause
// Takes the islands through a step, from impact to impact, and begins again where contacts were missed.
#pragma once

#include "state/context.h"

namespace rbs::step_controller {

/// Advances every island to the end of the step. At each impact the two islands that it concerns are advanced
/// to its time, the impact is resolved, the islands are merged if the bodies stay together, and go on over
/// the rest of the step.
void advanceIslands(Context& context);

}  // namespace rbs::step_controller

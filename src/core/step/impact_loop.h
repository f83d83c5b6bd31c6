// SPDX-License-Identifier: BSD-3-Clause
// The impacts of a step, in the order of their times.
#pragma once

#include "state/context.h"

namespace rbs {

/// Takes the impacts of step.impacts and those that follow from them: at each, the two islands it concerns
/// are brought to its time and the impact is resolved; bodies that stay together become one island, and what
/// the two will meet on their new trajectories is found. Leaves the islands where their last impact was, or where those are
/// with which they have become one.
void takeImpacts(Context& context);

}  // namespace rbs

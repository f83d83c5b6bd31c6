// SPDX-License-Identifier: BSD-3-Clause
// Pairs that a step left to themselves and that overlap after it: contacts have pushed a body off the motion
// on which it was predicted to pass another.
#pragma once

#include "state/context.h"

#include <utility>
#include <vector>

namespace rbs {

/// Of the bodies that contacts may have pushed, at the end of the step; i < j, in canonical order. Pairs that
/// rebound are not among them: an impact in the next step gives them the rebound that contact would take.
IndexPairs findMissedContacts(const Context& context);

}  // namespace rbs

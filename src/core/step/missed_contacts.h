// SPDX-License-Identifier: BSD-3-Clause
// Pairs that contacts have brought together although their predicted motions would not have met. The solver has not
// looked at them, so that after the step they overlap, or have passed through each other.
#pragma once

#include "state/context.h"

#include <utility>
#include <vector>

namespace rbs {

/// Of the bodies that contacts may have pushed, at the end of the step; i < j, in canonical order. An overlap counts
/// that contacts would not part again in the next step, or not on the side from which the two came; at the exact
/// settings any overlap of a pair that the solver has not looked at, or, where it rebounds, one past the middle: an
/// impact in the next step gives it the rebound that contact would take.
IndexPairs findMissedContacts(const Context& context);

/// Whether two bodies, where they are at `time`, overlap so deeply.
bool overlapDeeply(const Context& context, Index i, Index j, double time);

}  // namespace rbs

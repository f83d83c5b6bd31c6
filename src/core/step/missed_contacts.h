// SPDX-License-Identifier: BSD-3-Clause
// Pairs that contacts have brought together although their predicted motions would not have met. The solver has not
// looked at them, so that after the step they overlap, or have passed through each other.
#pragma once

#include "state/context.h"

#include <utility>
#include <vector>

namespace rbs {

/// Of the bodies that contacts may have pushed, at the end of the step; i < j, in canonical order. A pair is missed when its
/// overlap exceeds a share of the smaller length. At the fast settings that is 0.1, beyond which soft contacts may push a
/// body out on the wrong side. At the exact ones it is 1e-7, since they leave no overlap in pairs that they solve; and 0.5 for
/// a pair with restitution, since an impact in the next step still gives it its rebound.
IndexPairs findMissedContacts(const Context& context);

/// Whether two bodies, where they are at `time`, overlap so deeply.
bool overlapDeeply(const Context& context, Index i, Index j, double time);

}  // namespace rbs

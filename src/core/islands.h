// SPDX-License-Identifier: BSD-3-Clause
// Islands: bodies that contacts tie together, each advanced by the method it needs.
#pragma once

#include "context.h"

namespace rbs::islands {

Need need(const Census& census);

/// Groups the movers by the pairs that do not wait for an impact. Fills step.islands and step.island.
void link(Context& context);

/// Advances an island to this time, if it is not there yet.
void bringTo(Context& context, Island& island, double time);

/// Advances every island to the end of the step, from impact to impact: at each impact the two islands it
/// concerns are brought to its time, the impact is resolved, they are linked anew if the bodies stay
/// together, and go on over the rest of the step.
void advance(Context& context);

}  // namespace rbs::islands

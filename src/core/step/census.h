// SPDX-License-Identifier: BSD-3-Clause
// The census: goes through the bodies, and decides which effects the scene needs and which body feels them.
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs {

/// Goes through the bodies once: remakes the dense lists, decides the effects and what each body feels of
/// them. Returns the census.
Census takeCensus(SceneStore& scene);
/// The same after an edit of these bodies and of what pulls at them, and of nothing else but that bodies were
/// appended: looks only at those. Looks at all where what others feel has changed: an effect, or whom they
/// may meet.
Census takeCensus(SceneStore& scene, const std::vector<Index>& changed);
/// Takes a body out of tally and lists, before it is erased.
void uncountBody(SceneStore& scene, Index i);

}  // namespace rbs

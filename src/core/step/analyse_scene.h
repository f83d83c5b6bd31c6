// SPDX-License-Identifier: BSD-3-Clause
// The scene analysis goes through the bodies, and decides which effects the scene needs and which body feels
// them.
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs {

/// Goes through the bodies once: remakes the dense lists, decides the effects and what each body feels of
/// them.
SceneAnalysis analyseScene(SceneStore& scene);
/// The same after an edit of these bodies and of what pulls at them, and of nothing else but that bodies were
/// appended: looks only at those. Looks at all where what others feel has changed: an effect, or whom they
/// may meet.
SceneAnalysis analyseScene(SceneStore& scene, const std::vector<Index>& changed);
/// Removes a body from the counts and lists, before it is erased.
void removeFromAnalysis(SceneStore& scene, Index i);

}  // namespace rbs

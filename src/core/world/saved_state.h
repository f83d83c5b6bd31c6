// SPDX-License-Identifier: BSD-3-Clause
// Saved states: captures what the definitions of the bodies do not hold, and restores it.
#pragma once

#include "rigid_body_sim/world.h"
#include "state/context.h"

#include <string>
#include <vector>

namespace rbs {

SavedState captureState(const SceneStore& scene);
SavedState captureExactState(const SceneStore& scene);

/// Every fault of a saved state of these bodies, in a world with these settings.
std::vector<Problem> validate(const SavedState& saved, const SceneDef& settings, const Bodies& known);

/// Every fault of a grab, of a saved state or of a command; `path` names it.
void checkGrab(const Grab& grab, const std::string& path, std::vector<Problem>& problems);

/// Restores the time, the contacts and the wrenches of a sound state. To be called before analyseScene().
void restoreForces(const SavedState& saved, SceneStore& scene);
/// Restores grabs, holds and frozen bodies of a sound state. To be called before analyseScene().
void restoreUserForces(const SavedState& saved, SceneStore& scene);

/// Restores orientations that are not integrated, and sleeping islands. To be called after analyseScene().
/// Returns whether analyseScene() must be called again.
bool restoreRotationAndRest(const SavedState& saved, SceneStore& scene);

}  // namespace rbs

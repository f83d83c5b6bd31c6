// SPDX-License-Identifier: BSD-3-Clause
// What a saved state holds beyond the definitions of its bodies: reading it from the store, and putting it
// back.
#pragma once

#include "context.h"
#include "rigid_body_sim/world.h"

namespace rbs {

SavedState captureState(const SceneStore& scene);

/// What is wrong with a saved state of so many bodies.
std::vector<Problem> validate(const SavedState& saved, Index bodies);

/// Puts back the time, the contacts and the wrenches of a sound state; before the census is taken.
void restoreForces(const SavedState& saved, SceneStore& scene);

/// Puts back attitudes that are counted from an earlier time, and who sleeps; after the census. Returns
/// whether the census is to be taken again.
bool restoreRotationAndRest(const SavedState& saved, SceneStore& scene);

}  // namespace rbs

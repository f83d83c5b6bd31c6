// SPDX-License-Identifier: BSD-3-Clause
// Sleep: groups of bodies at rest that are left out of the step until something comes near.
//
// Asleep, a body stands still like a static one, and nothing is computed for it but its bounds. What it would
// still have settled by is lost, so a scene has to ask for it (`effects: {sleeping: on}`).
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs::sleep {

/// After the broad phase: finds the groups that a moving body comes near. If there are any, step.woken lists
/// their bodies, and the step is to be begun again with them awake.
void findWoken(Context& context);

/// The sleepers that one of these edges ties to a body that moves, maybe several times.
std::vector<Index> reachedSleepers(const SceneStore& scene, const std::vector<Edge>& edges);

/// Adds the groups that these bodies sleep in to step.woken: the step is to begin again with them awake.
void wakeGroups(Context& context, const std::vector<Index>& sleepers);

/// After the step: finds the groups that have been at rest for long enough, and lists them in
/// step.falling_asleep.
void update(Context& context);

/// Bodies to sleep, as one group, or awake again; analyseScene() must run afterwards.
void putToSleep(SceneStore& scene, const std::vector<Index>& bodies);
void wake(SceneStore& scene, const std::vector<Index>& bodies);
void wakeAll(SceneStore& scene);

}  // namespace rbs::sleep

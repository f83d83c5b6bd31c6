// SPDX-License-Identifier: BSD-3-Clause
// Names in requests: bodies, and frames, which are the world or a body.
#pragma once

#include "rigid_body_sim/snapshot.h"
#include "rigid_body_sim/world.h"

#include <string>
#include <vector>

namespace rbs {

/// The body of this name. Throws InvalidInput with the nearest name and some others for an unknown one.
BodyId bodyNamed(const World& world, const std::string& name);
/// Its place in `snapshot.bodies` and `snapshot.states`. The same error.
std::size_t indexNamed(const Snapshot& snapshot, const std::string& name);

/// Place of a frame in W: "" and "world" are W itself, any other name is a body. The same error.
Pose frameNamed(const Snapshot& snapshot, const std::string& frame_id);
Pose frameNamed(const World& world, const std::string& frame_id);

/// A pose given in a frame that is at `X_WF` in W, seen from W.
Pose compose(const Pose& X_WF, const Pose& X_FB);

}  // namespace rbs

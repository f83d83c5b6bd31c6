// SPDX-License-Identifier: BSD-3-Clause
// Names in requests: bodies, and frames, which are the world, a body, or known in tf.
#pragma once

#include "rigid_body_sim/snapshot.h"
#include "rigid_body_sim/world.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// The body of this name. Throws InvalidInput with the nearest name and some others for an unknown one, and with
/// the field of the request for an empty one.
BodyId bodyNamed(const World& world, const std::string& name, const std::string& field = "name");
/// The body whose frame this is: its name, with or without framePrefix(). The same error.
BodyId bodyOfFrame(const World& world, const std::string& frame_id, const std::string& field);
/// Its place in `snapshot.bodies` and `snapshot.states`. The same error.
std::size_t indexNamed(const Snapshot& snapshot, const std::string& name, const std::string& field = "name");

/// Place in W of a frame of tf. Throws InvalidInput with the reason.
using FrameLookup = std::function<Pose(const std::string& frame_id)>;

/// How frames are found that are neither the world nor a body. To be called before the services are offered.
void findFramesBy(FrameLookup lookup);

/// Place of a frame in W: "" and worldFrame() are W itself, a body's name, with or without framePrefix(), is
/// its frame B, and any other is looked up. The same error.
Pose frameNamed(const Snapshot& snapshot, const std::string& frame_id);
Pose frameNamed(const World& world, const std::string& frame_id);

/// The same vector. Throws InvalidInput where it is not finite: before a frame turns it, so that a refusal
/// shows what was sent.
const Vec3& finiteVector(const Vec3& v, const std::string& path);

/// The same orientation, with the same error.
const Quat& finiteOrientation(const Quat& q, const std::string& path);

/// A pose given in a frame that is at `X_WF` in W, seen from W.
Pose compose(const Pose& X_WF, const Pose& X_FB);

}  // namespace rbs

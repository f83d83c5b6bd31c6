// SPDX-License-Identifier: BSD-3-Clause
// Whether what was measured on a scene still holds for it.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <string>

namespace rbs {

/// What has changed of the scene between two snapshots, "gravity was changed"; empty: nothing. The state of
/// the bodies, the solver settings, colours and the view do not count. Costs one pass over the bodies where
/// their descriptions have changed.
std::string sceneChange(const Snapshot& then, const Snapshot& now);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The context menu of a body.
#pragma once

#include <visualization_msgs/MenuEntry.h>

#include <optional>
#include <vector>

#include "menu_titles.h"
#include "rigid_body_sim/world.h"

namespace rbs {

/// What the menu of this body offers.
std::vector<visualization_msgs::MenuEntry> menuEntries(const BodyDescription& body);

/// Does what an entry says and says so ("deleted"), save for Resize, which is the view's affair. Nothing, for
/// what is no entry. `hit_W` is where the mouse met the body. Throws InvalidInput.
const char* runMenuAction(World& world, MenuAction action, const BodyDescription& body, const Pose& pose,
                          const std::optional<Vec3>& hit_W);

}  // namespace rbs

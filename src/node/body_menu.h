// SPDX-License-Identifier: BSD-3-Clause
// The context menu of a body.
#pragma once

#include <visualization_msgs/MenuEntry.h>

#include <optional>
#include <vector>

#include "rigid_body_sim/world.h"

namespace rbs {

/// Values of `menu_entry_id`. 0 is no entry.
enum class MenuAction { Delete = 1, Duplicate, MakeStatic, MakeDynamic, Push, Resize };

/// What the menu of this body offers.
std::vector<visualization_msgs::MenuEntry> menuEntries(const BodyDescription& body);

/// Does what an entry says, save for Resize, which is the view's affair. `hit_W` is where the mouse met the
/// body. Throws InvalidInput.
void runMenuAction(World& world, MenuAction action, const BodyDescription& body, const Pose& pose,
                   const std::optional<Vec3>& hit_W);

}  // namespace rbs

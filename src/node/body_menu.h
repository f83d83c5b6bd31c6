// SPDX-License-Identifier: BSD-3-Clause
// The context menu of a body.
#pragma once

#include <visualization_msgs/MenuEntry.h>

#include <optional>
#include <string>
#include <vector>

#include "menu_titles.h"
#include "rigid_body_sim/world.h"

namespace rbs {

/// The scope of a menu for these bodies.
MenuScope menuScope(const std::vector<BodyId>& bodies);

/// What the menu of this body offers for the bodies of `scope`.
std::vector<visualization_msgs::MenuEntry> menuEntries(const BodyDescription& body, const MenuScope& scope);

/// Does what an entry says, and says so ("crate: deleted"), save for Resize, which is the view's affair. Nothing, for
/// what is no entry. The last of `bodies` is the one at which the mouse was, and `hit_W` where it met that body. Throws
/// InvalidInput.
std::string runMenuAction(World& world, MenuAction action, const std::vector<BodyDescription>& bodies,
                          const std::optional<Vec3>& hit_W);

}  // namespace rbs

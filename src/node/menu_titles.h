// SPDX-License-Identifier: BSD-3-Clause
// What the context menu of a body offers, for the node that does it and the RViz tool that shows it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rbs {

/// Values of `menu_entry_id`. 0 is no entry.
enum class MenuAction { Delete = 1, Duplicate, MakeStatic, MakeDynamic, Push, Resize };

/// The entries for a body of this shape and kind, as BodyDescription.msg names them, in order.
inline std::vector<std::pair<MenuAction, const char*>> menuTitles(const std::string& shape,
                                                                  const std::string& kind) {
  std::vector<std::pair<MenuAction, const char*>> titles = {{MenuAction::Delete, "Delete"}};
  if (shape == "plane") return titles;
  titles.push_back({MenuAction::Duplicate, "Duplicate"});
  titles.push_back({MenuAction::Resize, "Resize"});
  if (kind == "dynamic") titles.push_back({MenuAction::Push, "Push"});
  if (kind != "static") titles.push_back({MenuAction::MakeStatic, "Make static"});
  if (kind != "dynamic") titles.push_back({MenuAction::MakeDynamic, "Make dynamic"});
  return titles;
}

}  // namespace rbs

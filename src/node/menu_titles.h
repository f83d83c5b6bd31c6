// SPDX-License-Identifier: BSD-3-Clause
// What the context menu of a body offers, for the node that does it and the RViz tool that shows it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rbs {

/// Values of `menu_entry_id`. 0 is no entry.
enum class MenuAction { Delete = 1, Duplicate, MakeStatic, MakeDynamic, Push, Resize };

/// The entries for a body of this shape and kind, as BodyDescription.msg names them, in order. `count`: the bodies that are
/// selected, where it is one of them, else 1. Push and Resize are for the body under the mouse alone.
inline std::vector<std::pair<MenuAction, std::string>> menuTitles(const std::string& shape,
                                                                  const std::string& kind,
                                                                  std::size_t count) {
  const std::string all = count > 1 ? " " + std::to_string(count) + " bodies" : "";
  const std::string one = count > 1 ? " this body" : "";
  std::vector<std::pair<MenuAction, std::string>> titles = {{MenuAction::Delete, "Delete" + all}};
  if (shape == "plane") return titles;
  titles.push_back({MenuAction::Duplicate, "Duplicate" + all});
  titles.push_back({MenuAction::Resize, "Resize" + one});
  if (kind == "dynamic") titles.push_back({MenuAction::Push, "Push" + one});
  if (kind != "static") titles.push_back({MenuAction::MakeStatic, "Make" + all + " static"});
  if (kind != "dynamic") titles.push_back({MenuAction::MakeDynamic, "Make" + all + " dynamic"});
  return titles;
}

}  // namespace rbs

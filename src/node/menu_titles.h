// SPDX-License-Identifier: BSD-3-Clause
// What the context menu of a body offers, for the node that does it and the RViz tool that shows it.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rbs {

/// 0 is no entry.
enum class MenuAction { Delete = 1, Duplicate, MakeStatic, MakeDynamic, Push, Resize };

/// The bodies that a menu is for: the body under the mouse alone, or all that are selected with it.
struct MenuScope {
  std::size_t count = 1;
  std::uint32_t mark =
      0;  ///< tells one set of several bodies from another, by their handles; 0: a body alone
};

/// For the bodies of these handles, in any order.
inline MenuScope menuScope(const std::vector<std::uint64_t>& ids) {
  if (ids.size() < 2) return {};
  std::uint64_t sum = 0;  // of well-mixed handles (the finalizer of SplitMix64)
  for (std::uint64_t id : ids) {
    id = (id ^ (id >> 30)) * 0xbf58476d1ce4e5b9u;
    id = (id ^ (id >> 27)) * 0x94d049bb133111ebu;
    sum += id ^ (id >> 31);
  }
  return {ids.size(), static_cast<std::uint32_t>(sum >> 37) + 1};
}

constexpr std::uint32_t kMenuActions = 8;  ///< more than there are, with 0

/// A `menu_entry_id` has the mark of its bodies as well, so that no entry does to others what its title said of them.
inline std::uint32_t menuEntryId(MenuAction action, std::uint32_t mark) {
  return static_cast<std::uint32_t>(action) + kMenuActions * mark;
}

/// The entries for a body of this shape and kind, as BodyDescription.msg names them, in order: the `menu_entry_id` and the title
/// of each. Push and Resize are for the body under the mouse alone.
inline std::vector<std::pair<std::uint32_t, std::string>> menuTitles(const std::string& shape,
                                                                     const std::string& kind,
                                                                     const MenuScope& scope) {
  const std::string all = scope.count > 1 ? " " + std::to_string(scope.count) + " bodies" : "";
  const std::string one = scope.count > 1 ? " this body" : "";
  const auto ofAll = [&](MenuAction action) { return menuEntryId(action, scope.mark); };
  const auto ofOne = [](MenuAction action) { return menuEntryId(action, 0); };
  std::vector<std::pair<std::uint32_t, std::string>> titles = {{ofAll(MenuAction::Delete), "Delete" + all}};
  if (shape == "plane") return titles;
  titles.push_back({ofAll(MenuAction::Duplicate), "Duplicate" + all});
  titles.push_back({ofOne(MenuAction::Resize), "Resize" + one});
  if (kind == "dynamic") titles.push_back({ofOne(MenuAction::Push), "Push" + one});
  if (kind != "static") titles.push_back({ofAll(MenuAction::MakeStatic), "Make" + all + " static"});
  if (kind != "dynamic") titles.push_back({ofAll(MenuAction::MakeDynamic), "Make" + all + " dynamic"});
  return titles;
}

}  // namespace rbs

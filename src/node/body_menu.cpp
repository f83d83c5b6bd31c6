// SPDX-License-Identifier: BSD-3-Clause
#include "body_menu.h"

#include "duplicate.h"

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

// Away from where the mouse met the body, which is the viewer's side, and upward; straight up where that
// has no horizontal direction. The speed v = 2 sqrt(g L), with L the size of the body and g standard
// gravity, is the same throw for a crumb and for a house: v^2 / (2 g) = 2 L high.
Vec3 pushVelocity(const BodyDescription& body, const Pose& pose, const std::optional<Vec3>& hit_W) {
  constexpr double kStandardGravity = 9.80665;  // m/s^2
  const double size = characteristicLength(body.shape);
  Vec3 away = hit_W ? Vec3(pose.p_WB - *hit_W) : Vec3::UnitX();
  away.z() = 0.0;
  const bool has_direction = away.norm() > 1e-3 * size;
  const Vec3 direction = has_direction ? Vec3(away.normalized() + 0.5 * Vec3::UnitZ()) : Vec3::UnitZ();
  return 2.0 * std::sqrt(kStandardGravity * size) * direction.normalized();
}

void setKind(World& world, BodyId id, BodyKind kind) {
  BodyEdit edit;
  edit.kind = kind;
  world.editBody(id, edit);
}

}  // namespace

std::vector<visualization_msgs::MenuEntry> menuEntries(const BodyDescription& body) {
  std::vector<visualization_msgs::MenuEntry> entries;
  for (const auto& [action, title] : menuTitles(shapeName(body.shape), kindName(body.kind))) {
    visualization_msgs::MenuEntry entry;
    entry.id = static_cast<std::uint32_t>(action);
    entry.title = title;
    entry.command_type = visualization_msgs::MenuEntry::FEEDBACK;
    entries.push_back(entry);
  }
  return entries;
}

const char* runMenuAction(World& world, MenuAction action, const BodyDescription& body, const Pose& pose,
                          const std::optional<Vec3>& hit_W) {
  switch (action) {
    case MenuAction::Delete:
      return world.removeBody(body.id), "deleted";
    case MenuAction::Duplicate:
      return duplicate(world, {body.name}, 1, Vec3::Zero()), "duplicated";
    case MenuAction::MakeStatic:
      return setKind(world, body.id, BodyKind::Static), "static now";
    case MenuAction::MakeDynamic:
      return setKind(world, body.id, BodyKind::Dynamic), "dynamic now";
    case MenuAction::Push:
      return world.applyImpulse(body.id, body.mass * pushVelocity(body, pose, hit_W), pose.p_WB), "pushed";
    case MenuAction::Resize:
      break;
  }
  return "";
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "body_menu.h"

#include "duplicate.h"
#include "rigid_body_sim/quote.h"
#include "words.h"

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

void setKind(World& world, const std::vector<BodyDescription>& bodies, BodyKind kind) {
  BodyEdit edit;
  edit.kind = kind;
  for (const BodyDescription& body : bodies) world.editBody(body.id, edit);
}

// Nothing is above a plane.
std::string duplicateAbove(World& world, const std::vector<BodyDescription>& bodies) {
  std::vector<std::string> names;
  std::string planes;
  for (const BodyDescription& body : bodies) {
    if (std::holds_alternative<Plane>(body.shape)) {
      planes += (planes.empty() ? "" : ", ") + quoted(body.name);
    } else {
      names.push_back(body.name);
    }
  }
  duplicate(world, names, 1, Vec3::Zero());
  const std::string done = (names.size() == 1 ? names[0] : bodyCount(names.size())) + ": duplicated";
  return planes.empty() ? done : done + ", but not " + planes + ": the copy of a plane needs an offset";
}

}  // namespace

MenuScope menuScope(const std::vector<BodyId>& bodies) {
  std::vector<std::uint64_t> ids;
  for (const BodyId body : bodies) ids.push_back(body.serial);
  return menuScope(ids);
}

std::vector<visualization_msgs::MenuEntry> menuEntries(const BodyDescription& body, const MenuScope& scope) {
  std::vector<visualization_msgs::MenuEntry> entries;
  for (const auto& [id, title] : menuTitles(shapeName(body.shape), kindName(body.kind), scope)) {
    visualization_msgs::MenuEntry entry;
    entry.id = id;
    entry.title = title;
    entry.command_type = visualization_msgs::MenuEntry::FEEDBACK;
    entries.push_back(entry);
  }
  return entries;
}

std::string runMenuAction(World& world, MenuAction action, const std::vector<BodyDescription>& bodies,
                          const std::optional<Vec3>& hit_W) {
  const BodyDescription& body = bodies.back();
  const std::string all = bodies.size() == 1 ? body.name : bodyCount(bodies.size());
  switch (action) {
    case MenuAction::Delete:
      for (const BodyDescription& each : bodies) world.removeBody(each.id);
      return all + ": deleted";
    case MenuAction::Duplicate:
      return duplicateAbove(world, bodies);
    case MenuAction::MakeStatic:
      return setKind(world, bodies, BodyKind::Static), all + ": static now";
    case MenuAction::MakeDynamic:
      return setKind(world, bodies, BodyKind::Dynamic), all + ": dynamic now";
    case MenuAction::Push: {
      const Pose pose = world.pose(body.id);
      world.applyImpulse(body.id, body.mass * pushVelocity(body, pose, hit_W), pose.p_WB);
      return body.name + ": pushed";
    }
    case MenuAction::Resize:
      break;
  }
  return body.name + ": ";
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "same_scene.h"

#include <algorithm>
#include <map>

namespace rbs {
namespace {

bool same(const Material& a, const Material& b) {
  return a.friction == b.friction && a.restitution == b.restitution &&
         a.drag_coefficient == b.drag_coefficient && a.rolling_resistance == b.rolling_resistance &&
         a.torsional_resistance == b.torsional_resistance;
}

bool same(const BodyDescription& a, const BodyDescription& b) {
  return a.kind == b.kind && a.mass == b.mass && a.inertia == b.inertia && a.frozen == b.frozen &&
         a.group == b.group && a.mask == b.mask && same(a.material, b.material) &&
         sameShape(a.shape, b.shape);
}

bool same(const std::optional<Fluid>& a, const std::optional<Fluid>& b) {
  return a.has_value() == b.has_value() && (!a || (a->density == b->density && a->level == b->level));
}

bool same(const AirState& a, const AirState& b) {
  return a.air == b.air && a.wind == b.wind && a.density == b.density && a.mean == b.mean && a.gust == b.gust;
}

std::string bodiesChange(const std::vector<BodyDescription>& then, const std::vector<BodyDescription>& now) {
  const auto byName = [](const BodyDescription& a, const BodyDescription& b) { return a.name < b.name; };
  std::vector<BodyDescription> a = then, b = now;
  std::sort(a.begin(), a.end(), byName);
  std::sort(b.begin(), b.end(), byName);
  for (std::size_t k = 0; k < std::max(a.size(), b.size()); ++k) {
    if (k == b.size() || (k < a.size() && a[k].name < b[k].name)) return "'" + a[k].name + "' was deleted";
    if (k == a.size() || b[k].name < a[k].name) return "'" + b[k].name + "' was added";
    if (!same(a[k], b[k])) return "'" + b[k].name + "' was changed";
  }
  return "";
}

// A conveyor or a turntable is what its velocity makes of it.
std::string motionChange(const Snapshot& then, const Snapshot& now) {
  const auto motions = [](const Snapshot& snapshot) {
    std::map<std::string, Twist> found;
    for (std::size_t k = 0; k < snapshot.bodies->size(); ++k) {
      const BodyDescription& body = (*snapshot.bodies)[k];
      if (body.kind == BodyKind::Kinematic) found[body.name] = snapshot.states[k].twist;
    }
    return found;
  };
  const std::map<std::string, Twist> before = motions(then);
  for (const auto& [name, twist] : motions(now)) {
    const Twist& earlier = before.at(name);
    if (twist.v_WB != earlier.v_WB || twist.w_WB != earlier.w_WB)
      return "the velocity of '" + name + "' was changed";
  }
  return "";
}

}  // namespace

std::string sceneChange(const Snapshot& then, const Snapshot& now) {
  if (then.scene != now.scene) return "'" + now.scene + "' was loaded";
  if (then.step != now.step) return "the length of a step was changed";
  if (then.gravity != now.gravity) return "gravity was changed";
  if (!same(then.air, now.air)) return "the air was changed";
  if (!same(then.fluid, now.fluid)) return "the fluid was changed";
  if (then.effects != now.effects) return "the effects were changed";
  const std::string change = then.bodies == now.bodies ? "" : bodiesChange(*then.bodies, *now.bodies);
  return change.empty() ? motionChange(then, now) : change;
}

}  // namespace rbs

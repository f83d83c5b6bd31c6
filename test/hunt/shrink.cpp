// SPDX-License-Identifier: BSD-3-Clause
#include "shrink.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace rbs::hunt {

namespace {

constexpr int kMostTries = 300;

using Change = std::function<void(SceneDef&)>;

std::vector<Change> changesOf(const SceneDef& scene) {
  std::vector<Change> changes;
  for (std::size_t k = scene.bodies.size(); k-- > 0;)
    changes.emplace_back(
        [k](SceneDef& s) { s.bodies.erase(s.bodies.begin() + static_cast<std::ptrdiff_t>(k)); });
  if (scene.air) changes.emplace_back([](SceneDef& s) { s.air.reset(); });
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodyDef& body = scene.bodies[k];
    if (!body.twist.w_WB.isZero(0.0))
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].twist.w_WB.setZero(); });
    if (!body.twist.v_WB.isZero(0.0))
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].twist.v_WB.setZero(); });
    if (!body.pose.q_WB.isApprox(Quat::Identity(), 0.0))
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].pose.q_WB.setIdentity(); });
    if (body.density && *body.density != kDefaultDensity)
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].density = kDefaultDensity; });
    const Material& material = body.material;
    if (material.rolling_resistance != 0.0 || material.torsional_resistance != 0.0)
      changes.emplace_back([k](SceneDef& s) {
        s.bodies[k].material.rolling_resistance = s.bodies[k].material.torsional_resistance = 0.0;
      });
    if (material.friction != 0.0)
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].material.friction = 0.0; });
    if (material.restitution != 0.0)
      changes.emplace_back([k](SceneDef& s) { s.bodies[k].material.restitution = 0.0; });
  }
  return changes;
}

}  // namespace

Small shrink(const SceneDef& scene, const Demands& demands, const Finding& finding) {
  Small small{scene, finding};
  Demands shorter = demands;
  int tries = 0;
  for (bool smaller = true; smaller;) {
    smaller = false;
    shorter.steps = std::min(shorter.steps, small.finding.step);
    for (const Change& change : changesOf(small.scene)) {
      if (++tries > kMostTries) return small;
      SceneDef tried = small.scene;
      change(tried);
      const auto broken = firstBroken(tried, shorter);
      if (!broken || broken->invariant != finding.invariant) continue;
      small = {tried, *broken};
      smaller = true;
      break;
    }
  }
  return small;
}

}  // namespace rbs::hunt

// SPDX-License-Identifier: BSD-3-Clause
#include "step/sleep.h"

#include "base/disjoint_sets.h"
#include "step/constraints.h"
#include "step/depenetration.h"

#include <algorithm>
#include <cmath>

namespace rbs::sleep {

namespace {

// At rest: no point of its surface is faster than this share of what gravity adds in a step, for this long,
// s.
constexpr double kStill = 1e-3, kRest = 0.5;

bool isStill(const SceneStore& scene, Index i, double h) {
  return scene.bodies.mostSpeed(i) <= kStill * h * scene.gravity_W.norm();
}

bool moves(const SceneStore& scene, Index i) {
  const Traits& t = scene.bodies.traits[i];
  const Twist& twist = scene.bodies.twist[i];
  return t.moved_by_forces() || (t.is_kinematic() && !(twist.v_WB.isZero(0.0) && twist.w_WB.isZero(0.0)));
}

// Whether one of its bodies moves. One that sleeps does not.
bool isMoved(const SceneStore& scene, const Edge& edge) {
  return std::any_of(edge.bodies.begin(), edge.bodies.end(),
                     [&](Index i) { return i != kNone && moves(scene, i); });
}

}  // namespace

void findWoken(Context& context) {
  wakeGroups(context, reachedSleepers(context.scene, constraints::wakingEdges(context.scene)));
}

std::vector<Index> reachedSleepers(const SceneStore& scene, const std::vector<Edge>& edges) {
  std::vector<Index> sleepers;
  for (const Edge& edge : edges)
    for (const Index sleeper : edge.bodies)
      if (sleeper != kNone && scene.bodies.traits[sleeper].asleep && isMoved(scene, edge))
        sleepers.push_back(sleeper);
  return sleepers;
}

void wakeGroups(Context& context, const std::vector<Index>& sleepers) {
  if (sleepers.empty()) return;
  const SceneStore& scene = context.scene;
  std::vector<std::uint32_t> groups;
  for (const Index i : sleepers) groups.push_back(scene.rest[i].group);
  std::sort(groups.begin(), groups.end());
  for (Index i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies.traits[i].asleep &&
        std::binary_search(groups.begin(), groups.end(), scene.rest[i].group))
      context.step.woken.push_back(i);
}

namespace {

// Whether one of its bodies moves that no forces move.
bool isDriven(const Context& context, const Edge& edge) {
  return std::any_of(edge.bodies.begin(), edge.bodies.end(), [&](Index i) {
    return i != kNone && context.step.island[i] == kNone && moves(context.scene, i);
  });
}

// Islands that are near each other go to sleep together: a body that is awake wakes what sleeps near it.
std::vector<std::vector<Index>> nearIslands(const Context& context) {
  const StepStore& step = context.step;
  DisjointSets sets(static_cast<Index>(step.islands.size()));
  for (const Contact& contact : context.scene.contacts.active) {
    const Index a = step.island[contact.i], b = step.island[contact.j];
    if (contact.state.isSeparated() && a != kNone && b != kNone) sets.unite(a, b);
  }
  std::vector<std::vector<Index>> groups(step.islands.size());
  for (Index k = 0; k < step.islands.size(); ++k) groups[sets.root(k)].push_back(k);
  return groups;
}

}  // namespace

// A group goes to sleep as a whole. What is near a kinematic body that moves, or pulled by a user force or a
// wrench, or blown at by wind, stays awake: what holds it changes. So does what overlaps deeply: it is moved
// apart without a velocity that tells it.
void update(Context& context) {
  SceneStore& scene = context.scene;
  StepStore& step = context.step;
  scene.rest.resize(scene.bodies.size());
  const auto steps = static_cast<std::uint32_t>(std::ceil(kRest / step.h()));
  std::vector<char> pulled(scene.bodies.size(), 0);
  for (const BodyGrab& grab : scene.grabs) pulled[scene.bodies.indexOf(grab.body)] = 1;
  for (const TimedWrench& wrench : scene.wrenches) pulled[scene.bodies.indexOf(wrench.body)] = 1;
  const bool blown = scene.effects[Effect::Drag] && scene.settings.wind;
  if (step.islands.empty()) return;  // nor has `island` any
  std::vector<char> is_ready(step.islands.size(), 0);
  for (Index k = 0; k < step.islands.size(); ++k) {
    const Island& island = step.islands[k];
    const bool parts = std::any_of(island.contacts.begin(), island.contacts.end(), [&](Index contact) {
      return depenetration::isDeep(context, scene.contacts.active[contact]);
    });
    bool ready = !blown && !island.bodies.empty();  // empty: another island has taken it in
    for (const Index i : island.bodies) {
      std::uint32_t& rested = scene.rest[i].steps;
      const bool rests = !parts && !step.isCrowded(i) && isStill(scene, i, step.h());
      rested = rests ? std::min(rested + 1, steps) : 0;
      ready = ready && rested >= steps && !pulled[i] && scene.bodies.traits[i].moved_by_forces();
    }
    is_ready[k] = ready;
  }
  for (const Edge& edge : constraints::wakingEdges(scene))
    for (const Index i : edge.bodies)
      if (i != kNone && step.island[i] != kNone && isDriven(context, edge)) is_ready[step.island[i]] = 0;
  for (const std::vector<Index>& group : nearIslands(context)) {
    if (group.empty() || !std::all_of(group.begin(), group.end(), [&](Index k) { return is_ready[k]; }))
      continue;
    std::vector<Index>& bodies = step.falling_asleep.emplace_back();
    for (const Index k : group)
      bodies.insert(bodies.end(), step.islands[k].bodies.begin(), step.islands[k].bodies.end());
  }
}

// The number of a group is that of its oldest body, so that it means the same in a saved state.
void putToSleep(SceneStore& scene, const std::vector<Index>& bodies) {
  const Index oldest = *std::min_element(bodies.begin(), bodies.end());
  for (const Index i : bodies) {
    scene.bodies.updateOrientation(i, scene.time);
    scene.bodies.traits[i].asleep = true;
    scene.bodies.twist[i] = {};
    scene.bodies.refresh(i);
    scene.bodies.advance[i] = {"asleep", scene.bodies.id[oldest]};
    scene.rest[i].group = oldest;
  }
}

void wake(SceneStore& scene, const std::vector<Index>& bodies) {
  for (const Index i : bodies) {
    scene.bodies.traits[i].asleep = false;
    scene.bodies.refresh(i);
    scene.rest[i] = {};
  }
}

void wakeAll(SceneStore& scene) {
  if (scene.rest.empty()) return;
  std::vector<Index> sleepers;
  for (Index i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies.traits[i].asleep) sleepers.push_back(i);
  scene.rest.resize(scene.bodies.size());
  wake(scene, sleepers);
  scene.rest.clear();
}

}  // namespace rbs::sleep

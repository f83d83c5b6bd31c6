// SPDX-License-Identifier: BSD-3-Clause
#include "step/analyse_scene.h"

#include "effects/effects.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs {

namespace {

using Layer = SceneCounts::Layer;

Layer layerOf(const Bodies& bodies, Index i) {
  const Traits& t = bodies.traits[i];
  return Layer(t.group, t.mask, t.movable());
}

std::set<Layer> partneredOf(const std::map<Layer, Index>& layers) {
  std::set<Layer> partnered;
  for (const auto& [a, size] : layers) {
    const auto& [group_a, mask_a, moves_a] = a;
    for (const auto& [b, others] : layers) {
      const auto& [group_b, mask_b, moves_b] = b;
      if ((group_a & mask_b) && (group_b & mask_a) && (moves_a || moves_b) && (a != b || size > 1))
        partnered.insert(a);
    }
  }
  return partnered;
}

// Decides for each body what it feels, as detected or as forced. Goes by what the bodies are known to ask
// for.
class BodyEffects {
 public:
  explicit BodyEffects(const SceneStore& scene) : scene_(scene) {
    for (const BodyGrab& grab : scene.grabs) pulled_.insert(grab.body);
    for (const TimedWrench& wrench : scene.wrenches) pulled_.insert(wrench.body);
  }

  bool meets(Index i) const { return isOnFor(Effect::Collision, i); }
  // Only awake dynamic bodies feel what changes a motion.
  bool feels(Effect effect, Index i) const { return moved(i) && isOnFor(effect, i); }
  bool feelsSomeForce(Index i) const {
    return std::any_of(effects::kRows.begin(), effects::kRows.end(),
                       [&](const effects::Row& row) { return row.turns && feels(row.effect, i); });
  }
  bool isBallistic(Index i) const { return moved(i) && !isPulled(i) && !meets(i) && !feelsSomeForce(i); }
  bool isGyroscopic(Index i) const { return feels(Effect::Gyroscopic, i); }

  // Whether something may turn body i, or change its spin.
  bool mayBeTurned(Index i) const {
    if (!moved(i)) return false;
    const Traits& t = traits(i);
    const bool by_contact =
        meets(i) && (!t.round || (on(Effect::Friction) && t.material.friction > 0.0) || on(Effect::Rolling));
    const bool by_force = std::any_of(
        effects::kRows.begin(), effects::kRows.end(),
        [&](const effects::Row& row) { return row.turns && row.turns(t) && feels(row.effect, i); });
    return isGyroscopic(i) || by_contact || by_force || isPulled(i);
  }
  // Whether the step reads its orientation.
  bool showsOrientation(Index i) const {
    return isPulled(i) || (!traits(i).round && (meets(i) || feelsSomeForce(i)));
  }

 private:
  const Traits& traits(Index i) const { return scene_.bodies.traits[i]; }
  bool moved(Index i) const { return traits(i).moved_by_forces(); }
  bool on(Effect effect) const { return scene_.effects[effect]; }
  // An effect that is on is so for the bodies that ask for it, and for all when it is forced on.
  bool isOnFor(Effect effect, Index i) const {
    if (!on(effect)) return false;
    const auto forced = scene_.settings.effects.find(effect);
    return scene_.counts.entries[i].asks[static_cast<std::size_t>(effect)] ||
           (forced != scene_.settings.effects.end() && forced->second);
  }
  bool isPulled(Index i) const { return !pulled_.empty() && pulled_.count(scene_.bodies.id[i]) != 0; }

  const SceneStore& scene_;
  std::set<BodyId> pulled_;
};

// All but whether it asks for rotation, which what it feels decides.
SceneCounts::Entry lookAt(const SceneStore& scene, Index i) {
  const Traits& t = scene.bodies.traits[i];
  const Layer layer = layerOf(scene.bodies, i);
  const effects::Candidate candidate{t, scene.bodies.inertia[i], scene.counts.partnered.count(layer) != 0};
  SceneCounts::Entry entry{layer, t.shape.index(), t.moved_by_forces(), t.is_kinematic(), t.asleep};
  for (std::size_t k = 0; k < kEffects.size(); ++k)
    entry.asks[k] = effects::kRows[k].asks && effects::kRows[k].asks(candidate);
  return entry;
}

constexpr auto kCollision = static_cast<std::size_t>(Effect::Collision);
constexpr auto kRotation = static_cast<std::size_t>(Effect::Rotation);

void count(SceneAnalysis& c, const SceneCounts::Entry& entry, int by) {
  const auto n = static_cast<Index>(by);
  if (entry.moved) c.moved_by_forces += n;
  if (entry.kinematic) c.kinematic += n;
  if (entry.asleep) c.asleep += n;
  for (std::size_t k = 0; k < kEffects.size(); ++k)
    if (entry.asks[k]) c.asking[k] += n;
  if (entry.asks[kCollision]) c.shapes[entry.shape] += n;
}

// What the scene holds besides bodies.
void countSurroundings(const SceneStore& scene, SceneAnalysis& c) {
  c.bodies = scene.bodies.size();
  c.grabs = static_cast<Index>(scene.grabs.size());
  c.holds = static_cast<Index>(scene.holds.size());
  c.wrenches = static_cast<Index>(scene.wrenches.size());
  c.scene = scene.settings;
}

// The dense lists, and after them those by effect.
constexpr std::array kDenseLists{&BodyLists::ballistic, &BodyLists::tumbling,   &BodyLists::in_islands,
                                 &BodyLists::kinematic, &BodyLists::collidable, &BodyLists::planes};
constexpr std::size_t kLists = kDenseLists.size() + kEffects.size();

std::vector<Index>& listAt(BodyLists& lists, std::size_t k) {
  return k < kDenseLists.size() ? lists.*kDenseLists[k] : lists.feeling[k - kDenseLists.size()];
}

// Which lists a body is on.
std::array<bool, kLists> listsOf(const SceneStore& scene, const BodyEffects& body, Index i) {
  const Traits& t = scene.bodies.traits[i];
  const bool ballistic = body.isBallistic(i), meets = body.meets(i);
  std::array<bool, kLists> on{ballistic,
                              ballistic && !scene.bodies.inertia[i].lazy_orientation,
                              !ballistic && t.moved_by_forces(),
                              t.is_kinematic(),
                              meets && !t.unbounded,
                              meets && t.unbounded};
  for (std::size_t k = 0; k < kEffects.size(); ++k)
    on[kDenseLists.size() + k] = effects::kRows[k].turns && body.feels(kEffects[k], i);
  return on;
}

void startPairSearch(SceneStore& scene) {
  scene.pair_search = {};
  scene.pair_search.order = scene.lists.collidable;
}

// One body more, or one fewer.
void joinPairSearch(PairSearch& search, Index i) {
  search.order.push_back(i);
  ++search.changed;
}
void leavePairSearch(PairSearch& search, Index i) {
  search.order.erase(std::find(search.order.begin(), search.order.end(), i));
  ++search.changed;
}

// What a body feels of rotation. Its orientation is the same before and after, bit for bit.
void setRotation(SceneStore& scene, const BodyEffects& body, Index i) {
  Bodies& bodies = scene.bodies;
  Inertia& m = bodies.inertia[i];
  const auto forced = scene.settings.effects.find(Effect::Rotation);
  const bool turns = forced == scene.settings.effects.end() ? body.mayBeTurned(i) : forced->second;
  const bool steady = bodies.traits[i].moved_by_forces() && !(scene.effects[Effect::Rotation] && turns);
  const bool lazy_orientation = steady && !body.showsOrientation(i);
  if (lazy_orientation != m.lazy_orientation) bodies.updateOrientation(i, scene.time);
  m.gyroscopic = body.isGyroscopic(i);
  m.steady = steady;
  m.lazy_orientation = lazy_orientation;
  if (bodies.traits[i].moved_by_forces())
    m.inv_moments = steady ? Vec3::Zero().eval() : m.moments.cwiseInverse().eval();
}

}  // namespace

SceneAnalysis analyseScene(SceneStore& scene) {
  const Index n = scene.bodies.size();
  SceneCounts counts;
  counts.looks = scene.counts.looks + n;
  for (Index i = 0; i < n; ++i) ++counts.layers[layerOf(scene.bodies, i)];
  counts.partnered = partneredOf(counts.layers);
  scene.counts = std::move(counts);
  scene.effects = {};
  SceneAnalysis& c = scene.counts.analysis;
  countSurroundings(scene, c);
  std::vector<SceneCounts::Entry>& entries = scene.counts.entries;
  const BodyEffects body(scene);
  for (Index i = 0; i < n; ++i) count(c, entries.emplace_back(lookAt(scene, i)), 1);
  // In the order of their list: whether rotation is asked for depends on those before it.
  for (const Effect effect : kEffects) {
    if (effect == Effect::Rotation) {
      for (Index i = 0; i < n; ++i) {
        if (!body.mayBeTurned(i)) continue;
        entries[i].asks[kRotation] = true;
        ++c.asking[kRotation];
      }
    }
    scene.effects.set(effect, effects::need(effect, c).active);
  }
  scene.gravity_W = effects::isNeglected(Effect::Gravity, c) ? Vec3::Zero().eval() : scene.settings.gravity;
  for (Index i = 0; i < n; ++i) setRotation(scene, body, i);
  const std::vector<Index> collidable = std::move(scene.lists.collidable);
  scene.lists = {};
  for (Index i = 0; i < n; ++i) {
    const auto on = listsOf(scene, body, i);
    for (std::size_t k = 0; k < kLists; ++k)
      if (on[k]) listAt(scene.lists, k).push_back(i);
  }
  if (scene.lists.collidable != collidable) startPairSearch(scene);
  c.ballistic = static_cast<Index>(scene.lists.ballistic.size());
  scene.ballistic_until = scene.time;
  return c;
}

namespace {

// False where that is not enough; what it has done until then the analysis of all overwrites.
bool recount(SceneStore& scene, std::vector<Index> bodies) {
  SceneCounts& counts = scene.counts;
  for (Index i = static_cast<Index>(counts.entries.size()); i < scene.bodies.size(); ++i) bodies.push_back(i);
  const std::size_t known = counts.entries.size();
  counts.entries.resize(scene.bodies.size());
  for (const Index i : bodies) {
    const Layer now = layerOf(scene.bodies, i);
    if (i < known && --counts.layers[counts.entries[i].layer] == 0)
      counts.layers.erase(counts.entries[i].layer);
    ++counts.layers[now];
  }
  std::set<Layer> partnered = partneredOf(counts.layers);
  std::swap(counts.partnered, partnered);
  for (const auto& [layer, size] : counts.layers) {
    const bool others =
        size > static_cast<Index>(std::count_if(bodies.begin(), bodies.end(), [&, l = layer](Index i) {
          return layerOf(scene.bodies, i) == l;
        }));
    if (others && counts.partnered.count(layer) != partnered.count(layer)) return false;
  }

  counts.looks += bodies.size();
  countSurroundings(scene, counts.analysis);
  const BodyEffects body(scene);
  for (const Index i : bodies) {
    count(counts.analysis, counts.entries[i], -1);
    counts.entries[i] = lookAt(scene, i);
    counts.entries[i].asks[kRotation] = body.mayBeTurned(i);
    count(counts.analysis, counts.entries[i], 1);
  }
  for (const Effect effect : kEffects)
    if (effects::need(effect, counts.analysis).active != scene.effects[effect]) return false;

  for (const Index i : bodies) {
    setRotation(scene, body, i);
    const auto on = listsOf(scene, body, i);
    for (std::size_t k = 0; k < kLists; ++k) {
      std::vector<Index>& list = listAt(scene.lists, k);
      const auto place = std::lower_bound(list.begin(), list.end(), i);
      const bool was_on = place != list.end() && *place == i;
      if (on[k] == was_on) continue;
      on[k] ? void(list.insert(place, i)) : void(list.erase(place));
      if (&list == &scene.lists.collidable)
        on[k] ? joinPairSearch(scene.pair_search, i) : leavePairSearch(scene.pair_search, i);
    }
  }
  counts.analysis.ballistic = static_cast<Index>(scene.lists.ballistic.size());
  scene.ballistic_until = scene.time;
  return true;
}

}  // namespace

SceneAnalysis analyseScene(SceneStore& scene, const std::vector<Index>& changed) {
  return recount(scene, changed) ? scene.counts.analysis : analyseScene(scene);
}

void removeFromAnalysis(SceneStore& scene, Index i) {
  SceneCounts& counts = scene.counts;
  count(counts.analysis, counts.entries[i], -1);
  if (--counts.layers[counts.entries[i].layer] == 0) counts.layers.erase(counts.entries[i].layer);
  counts.entries.erase(counts.entries.begin() + i);
  for (std::size_t k = 0; k < kLists; ++k) {
    std::vector<Index>& list = listAt(scene.lists, k);
    auto place = std::lower_bound(list.begin(), list.end(), i);
    if (place != list.end() && *place == i) {
      place = list.erase(place);
      if (&list == &scene.lists.collidable) leavePairSearch(scene.pair_search, i);
    }
    for (; place != list.end(); ++place) --*place;
  }
  for (Index& other : scene.pair_search.order)
    if (other > i) --other;
}

}  // namespace rbs

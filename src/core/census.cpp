// SPDX-License-Identifier: BSD-3-Clause
#include "census.h"

#include "context.h"
#include "effects/effects.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs {

namespace {

auto fields(const Census& c) {
  return std::tie(c.bodies, c.moved_by_forces, c.led, c.asleep, c.collidable, c.shapes, c.ballistic,
                  c.asymmetric, c.rough, c.bouncy, c.rolling, c.dragged, c.turned, c.grabs, c.holds,
                  c.wrenches, c.gravity, c.air_density, c.fluid_density, c.fluid_level, c.wind, c.fidelity,
                  c.overrides);
}

using Layer = CensusTally::Layer;

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

// Decides for each body what it feels, as detected or as forced.
class BodyEffects {
 public:
  explicit BodyEffects(const SceneStore& scene) : scene_(scene) {
    for (const BodyGrab& grab : scene.grabs) pulled_.insert(grab.body);
    for (const TimedWrench& wrench : scene.wrenches) pulled_.insert(wrench.body);
  }

  bool mayMeet(Index i) const { return scene_.tally.partnered.count(layerOf(scene_.bodies, i)) != 0; }
  bool meets(Index i) const { return feels(Effect::Collision, mayMeet(i)); }
  bool isDragged(Index i) const { return moved(i) && feels(Effect::Drag, traits(i).dragCoefficient() > 0.0); }
  bool isBuoyant(Index i) const { return moved(i) && feels(Effect::Buoyancy, true); }
  bool isBallistic(Index i) const {
    return moved(i) && !isPulled(i) && !meets(i) && !isDragged(i) && !isBuoyant(i);
  }
  bool isGyroscopic(Index i) const {
    return moved(i) && feels(Effect::Gyroscopic, !scene_.bodies.inertia[i].isotropic);
  }

  // Whether something may turn body i, or change its spin.
  bool mayBeTurned(Index i) const {
    if (!moved(i)) return false;
    const Traits& t = traits(i);
    const bool ball = std::holds_alternative<Sphere>(t.shape);
    const bool by_contact =
        meets(i) && (!ball || (on(Effect::Friction) && t.material.friction > 0.0) || on(Effect::Rolling));
    const bool by_fluids = (isDragged(i) && std::holds_alternative<Box>(t.shape)) || (isBuoyant(i) && !ball);
    return isGyroscopic(i) || by_contact || by_fluids || isPulled(i);
  }
  // Whether the step asks for its attitude.
  bool showsAttitude(Index i) const {
    return isPulled(i) ||
           (!std::holds_alternative<Sphere>(traits(i).shape) && (meets(i) || isDragged(i) || isBuoyant(i)));
  }

 private:
  const Traits& traits(Index i) const { return scene_.bodies.traits[i]; }
  bool moved(Index i) const { return traits(i).moved_by_forces(); }
  bool on(Effect effect) const { return scene_.effects[effect]; }
  // An effect that is on is felt by the bodies that ask for it, and by all when it is forced on.
  bool feels(Effect effect, bool asks) const {
    const auto forced = scene_.settings.effects.find(effect);
    return on(effect) && (asks || (forced != scene_.settings.effects.end() && forced->second));
  }
  bool isPulled(Index i) const { return !pulled_.empty() && pulled_.count(scene_.bodies.id[i]) != 0; }

  const SceneStore& scene_;
  std::set<BodyId> pulled_;
};

// What a body is counted for, by the bits of its entry.
constexpr std::array kCounts{&Census::moved_by_forces, &Census::led,   &Census::asleep, &Census::collidable,
                             &Census::asymmetric,      &Census::rough, &Census::bouncy, &Census::rolling,
                             &Census::dragged,         &Census::turned};
constexpr std::uint32_t kCollidable = 1u << 3, kTurned = 1u << 9;
static_assert(kCounts[3] == &Census::collidable && kCounts[9] == &Census::turned);

// All but what turns it, which the effects decide.
CensusTally::Entry lookAt(const SceneStore& scene, const BodyEffects& body, Index i) {
  const Traits& t = scene.bodies.traits[i];
  const bool moved = t.moved_by_forces(), meets = body.mayMeet(i);
  const std::array<bool, kCounts.size() - 1> features{
      moved,
      t.led(),
      t.asleep,
      meets,
      moved && !scene.bodies.inertia[i].isotropic,
      meets && t.material.friction > 0.0,
      meets && t.material.restitution > 0.0,
      meets && (t.material.rolling_resistance > 0.0 || t.material.torsional_resistance > 0.0),
      moved && t.dragCoefficient() > 0.0};
  CensusTally::Entry entry{layerOf(scene.bodies, i), t.shape.index(), 0};
  for (std::size_t k = 0; k < features.size(); ++k) entry.features |= std::uint32_t{features[k]} << k;
  return entry;
}

void count(Census& c, const CensusTally::Entry& entry, int by) {
  for (std::size_t k = 0; k < kCounts.size(); ++k)
    if (entry.features >> k & 1u) c.*kCounts[k] += static_cast<Index>(by);
  if (entry.features & kCollidable) c.shapes[entry.shape] += static_cast<Index>(by);
}

// What the scene holds besides bodies.
void countSurroundings(const SceneStore& scene, Census& c) {
  const SceneDef& settings = scene.settings;
  c.bodies = scene.bodies.size();
  c.grabs = static_cast<Index>(scene.grabs.size());
  c.holds = static_cast<Index>(scene.holds.size());
  c.wrenches = static_cast<Index>(scene.wrenches.size());
  c.gravity = settings.gravity.norm();
  c.air_density = settings.air ? settings.air->density : 0.0;
  c.wind = settings.wind.has_value();
  if (settings.fluid) c.fluid_density = settings.fluid->density, c.fluid_level = settings.fluid->level;
  c.fidelity = settings.fidelity;
  c.overrides = settings.effects;
}

constexpr std::array kRosters{&Rosters::ballistic,  &Rosters::tumbling, &Rosters::movers,
                              &Rosters::led,        &Rosters::buoyant,  &Rosters::dragged,
                              &Rosters::collidable, &Rosters::planes};

// Which lists a body is on, in the order of kRosters.
std::array<bool, kRosters.size()> rostersOf(const SceneStore& scene, const BodyEffects& body, Index i) {
  const Traits& t = scene.bodies.traits[i];
  const bool ballistic = body.isBallistic(i), meets = body.meets(i),
             plane = std::holds_alternative<Plane>(t.shape);
  return {ballistic,
          ballistic && !scene.bodies.inertia[i].unturned,
          !ballistic && t.moved_by_forces(),
          t.led(),
          body.isBuoyant(i),
          body.isDragged(i),
          meets && !plane,
          meets && plane};
}

void startSweep(SceneStore& scene) {
  scene.sweep = {};
  scene.sweep.order = scene.rosters.collidable;
}

// What a body feels of rotation. Its attitude is the same before and after, bit for bit.
void setRotation(SceneStore& scene, const BodyEffects& body, Index i) {
  Bodies& bodies = scene.bodies;
  Inertia& m = bodies.inertia[i];
  const auto forced = scene.settings.effects.find(Effect::Rotation);
  const bool turns = forced == scene.settings.effects.end() ? body.mayBeTurned(i) : forced->second;
  const bool steady = bodies.traits[i].moved_by_forces() && !(scene.effects[Effect::Rotation] && turns);
  const bool unturned = steady && !body.showsAttitude(i);
  if (unturned != m.unturned) bodies.bringAttitude(i, scene.time);
  m.gyroscopic = body.isGyroscopic(i);
  m.steady = steady;
  m.unturned = unturned;
  if (bodies.traits[i].moved_by_forces())
    m.inv_moments = steady ? Vec3::Zero().eval() : m.moments.cwiseInverse().eval();
}

}  // namespace

bool operator==(const Census& a, const Census& b) {
  return fields(a) == fields(b);
}

Census takeCensus(SceneStore& scene) {
  const Index n = scene.bodies.size();
  CensusTally tally;
  tally.looks = scene.tally.looks + n;
  for (Index i = 0; i < n; ++i) ++tally.layers[layerOf(scene.bodies, i)];
  tally.partnered = partneredOf(tally.layers);
  scene.tally = std::move(tally);
  scene.effects = {};
  Census& c = scene.tally.census;
  countSurroundings(scene, c);
  std::vector<CensusTally::Entry>& entries = scene.tally.entries;
  const BodyEffects body(scene);
  for (Index i = 0; i < n; ++i) count(c, entries.emplace_back(lookAt(scene, body, i)), 1);
  // In the order of their list: whether rotation is asked for depends on those before it.
  for (const Effect effect : kEffects) {
    if (effect == Effect::Rotation) {
      for (Index i = 0; i < n; ++i) {
        if (!body.mayBeTurned(i)) continue;
        entries[i].features |= kTurned;
        ++c.turned;
      }
    }
    scene.effects.set(effect, effects::need(effect, c).active);
  }
  scene.gravity_W = effects::isNeglected(Effect::Gravity, c) ? Vec3::Zero().eval() : scene.settings.gravity;
  for (Index i = 0; i < n; ++i) setRotation(scene, body, i);
  const std::vector<Index> collidable = std::move(scene.rosters.collidable);
  scene.rosters = {};
  for (Index i = 0; i < n; ++i) {
    const auto on = rostersOf(scene, body, i);
    for (std::size_t k = 0; k < kRosters.size(); ++k)
      if (on[k]) (scene.rosters.*kRosters[k]).push_back(i);
  }
  if (scene.rosters.collidable != collidable) startSweep(scene);
  c.ballistic = static_cast<Index>(scene.rosters.ballistic.size());
  scene.ballistic_until = scene.time;
  return c;
}

namespace {

// False where that is not enough; what it has done until then is for a census of all to overwrite.
bool recount(SceneStore& scene, std::vector<Index> bodies) {
  CensusTally& tally = scene.tally;
  for (Index i = static_cast<Index>(tally.entries.size()); i < scene.bodies.size(); ++i) bodies.push_back(i);
  const std::size_t known = tally.entries.size();
  tally.entries.resize(scene.bodies.size());
  for (const Index i : bodies) {
    const Layer now = layerOf(scene.bodies, i);
    if (i < known && --tally.layers[tally.entries[i].layer] == 0) tally.layers.erase(tally.entries[i].layer);
    ++tally.layers[now];
  }
  std::set<Layer> partnered = partneredOf(tally.layers);
  std::swap(tally.partnered, partnered);
  for (const auto& [layer, size] : tally.layers) {
    const bool others =
        size > static_cast<Index>(std::count_if(bodies.begin(), bodies.end(), [&, l = layer](Index i) {
          return layerOf(scene.bodies, i) == l;
        }));
    if (others && tally.partnered.count(layer) != partnered.count(layer)) return false;
  }

  tally.looks += bodies.size();
  countSurroundings(scene, tally.census);
  const BodyEffects body(scene);
  for (const Index i : bodies) {
    count(tally.census, tally.entries[i], -1);
    tally.entries[i] = lookAt(scene, body, i);
    if (body.mayBeTurned(i)) tally.entries[i].features |= kTurned;
    count(tally.census, tally.entries[i], 1);
  }
  for (const Effect effect : kEffects)
    if (effects::need(effect, tally.census).active != scene.effects[effect]) return false;

  bool sorts_others = false;
  for (const Index i : bodies) {
    setRotation(scene, body, i);
    const auto on = rostersOf(scene, body, i);
    for (std::size_t k = 0; k < kRosters.size(); ++k) {
      std::vector<Index>& roster = scene.rosters.*kRosters[k];
      const auto place = std::lower_bound(roster.begin(), roster.end(), i);
      const bool was_on = place != roster.end() && *place == i;
      if (on[k] == was_on) continue;
      on[k] ? void(roster.insert(place, i)) : void(roster.erase(place));
      sorts_others = sorts_others || kRosters[k] == &Rosters::collidable;
    }
  }
  if (sorts_others) startSweep(scene);
  tally.census.ballistic = static_cast<Index>(scene.rosters.ballistic.size());
  scene.ballistic_until = scene.time;
  return true;
}

}  // namespace

Census takeCensus(SceneStore& scene, const std::vector<Index>& changed) {
  return recount(scene, changed) ? scene.tally.census : takeCensus(scene);
}

void uncountBody(SceneStore& scene, Index i) {
  CensusTally& tally = scene.tally;
  count(tally.census, tally.entries[i], -1);
  if (--tally.layers[tally.entries[i].layer] == 0) tally.layers.erase(tally.entries[i].layer);
  tally.entries.erase(tally.entries.begin() + i);
  for (const auto list : kRosters) {
    std::vector<Index>& roster = scene.rosters.*list;
    auto place = std::lower_bound(roster.begin(), roster.end(), i);
    if (place != roster.end() && *place == i) place = roster.erase(place);
    for (; place != roster.end(); ++place) --*place;
  }
  startSweep(scene);
}

double SceneStore::frictionOf(Index i, Index j) const {
  if (!effects[Effect::Friction]) return 0.0;
  return std::sqrt(bodies.traits[i].material.friction * bodies.traits[j].material.friction);
}

double SceneStore::restitutionOf(Index i, Index j) const {
  if (!effects[Effect::Restitution]) return 0.0;
  return std::max(bodies.traits[i].material.restitution, bodies.traits[j].material.restitution);
}

double fallSpeed(double gravity, double length) {
  constexpr double kEarth = 9.81;
  return std::sqrt((gravity > 0.0 ? gravity : kEarth) * length);
}

}  // namespace rbs

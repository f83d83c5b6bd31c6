#include "census.h"

#include "context.h"
#include "effects/effects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace rbs {

namespace {

auto fields(const Census& c) {
  return std::tie(c.bodies, c.moved_by_forces, c.led, c.asleep, c.collidable, c.shapes, c.ballistic, c.asymmetric,
                  c.rough, c.bouncy, c.rolling, c.dragged, c.turned, c.grabs, c.holds, c.wrenches, c.gravity,
                  c.air_density, c.fluid_density, c.fluid_level, c.wind, c.fidelity, c.overrides);
}

// By body: whether the masks let it meet another, one of the two moved by forces. Bodies of equal group, mask
// and kind are alike in this; there are few kinds of them.
std::vector<char> partnered(const Bodies& bodies) {
  using Layer = std::tuple<std::uint32_t, std::uint32_t, bool>;
  std::map<Layer, Index> sizes;
  const auto layerOf = [&](Index i) {
    const Traits& t = bodies.traits[i];
    return Layer(t.group, t.mask, t.movable());
  };
  for (Index i = 0; i < bodies.size(); ++i) ++sizes[layerOf(i)];
  std::map<Layer, bool> has_partner;
  for (const auto& [a, size] : sizes) {
    const auto& [group_a, mask_a, moves_a] = a;
    for (const auto& [b, others] : sizes) {
      const auto& [group_b, mask_b, moves_b] = b;
      if ((group_a & mask_b) && (group_b & mask_a) && (moves_a || moves_b) && (a != b || size > 1))
        has_partner[a] = true;
    }
  }
  std::vector<char> result(bodies.size());
  for (Index i = 0; i < bodies.size(); ++i) result[i] = has_partner.count(layerOf(i)) != 0;
  return result;
}

// Decides for each body what it feels, as detected or as forced.
class BodyEffects {
 public:
  explicit BodyEffects(const SceneStore& scene)
      : scene_(scene), partnered_(partnered(scene.bodies)), pulled_(scene.bodies.size(), 0) {
    for (const HandGrab& grab : scene.grabs) mark(grab.body);
    for (const TimedWrench& wrench : scene.wrenches) mark(wrench.body);
  }

  bool mayMeet(Index i) const { return partnered_[i]; }
  bool meets(Index i) const { return feels(Effect::Collision, mayMeet(i)); }
  bool isDragged(Index i) const {
    return moved(i) && feels(Effect::Drag, traits(i).dragCoefficient() > 0.0);
  }
  bool isBuoyant(Index i) const { return moved(i) && feels(Effect::Buoyancy, true); }
  bool isBallistic(Index i) const {
    return moved(i) && !pulled_[i] && !meets(i) && !isDragged(i) && !isBuoyant(i);
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
    return isGyroscopic(i) || by_contact || by_fluids || pulled_[i];
  }
  // Whether the step asks for its attitude.
  bool showsAttitude(Index i) const {
    return pulled_[i] || (!std::holds_alternative<Sphere>(traits(i).shape) &&
                          (meets(i) || isDragged(i) || isBuoyant(i)));
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
  void mark(BodyId body) {
    const Index i = scene_.bodies.indexOf(body);
    if (i != kNone) pulled_[i] = 1;
  }

  const SceneStore& scene_;
  std::vector<char> partnered_, pulled_;
};

// What the scene holds, whatever is forced.
Census countContents(const SceneStore& scene, const BodyEffects& body) {
  Census c;
  const SceneDef& settings = scene.settings;
  c.bodies = scene.bodies.size();
  for (Index i = 0; i < c.bodies; ++i) {
    const Traits& t = scene.bodies.traits[i];
    const bool moved = t.moved_by_forces();
    c.moved_by_forces += moved;
    c.led += t.led();
    c.asleep += t.asleep;
    c.asymmetric += moved && !scene.bodies.inertia[i].isotropic;
    c.dragged += moved && t.dragCoefficient() > 0.0;
    if (!body.mayMeet(i)) continue;
    ++c.collidable;
    ++c.shapes[t.shape.index()];
    c.rough += t.material.friction > 0.0;
    c.bouncy += t.material.restitution > 0.0;
    c.rolling += t.material.rolling_resistance > 0.0 || t.material.torsional_resistance > 0.0;
  }
  c.grabs = static_cast<Index>(scene.grabs.size());
  c.holds = static_cast<Index>(scene.holds.size());
  c.wrenches = static_cast<Index>(scene.wrenches.size());
  c.gravity = settings.gravity.norm();
  c.air_density = settings.air ? settings.air->density : 0.0;
  c.wind = settings.wind.has_value();
  if (settings.fluid) c.fluid_density = settings.fluid->density, c.fluid_level = settings.fluid->level;
  c.fidelity = settings.fidelity;
  c.overrides = settings.effects;
  return c;
}

Rosters listBodies(const SceneStore& scene, const BodyEffects& body) {
  Rosters r;
  for (Index i = 0; i < scene.bodies.size(); ++i) {
    const Traits& t = scene.bodies.traits[i];
    if (body.isBallistic(i)) {
      r.ballistic.push_back(i);
      if (!scene.bodies.inertia[i].unturned) r.tumbling.push_back(i);
    } else if (t.moved_by_forces()) {
      r.movers.push_back(i);
    }
    if (t.led()) r.led.push_back(i);
    if (body.isBuoyant(i)) r.buoyant.push_back(i);
    if (body.isDragged(i)) r.dragged.push_back(i);
    if (body.meets(i)) (std::holds_alternative<Plane>(t.shape) ? r.planes : r.collidable).push_back(i);
  }
  return r;
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
  scene.effects = {};
  Census c = countContents(scene, BodyEffects(scene));
  // In the order of their list: whether rotation is asked for depends on those before it.
  for (const Effect effect : kEffects) {
    if (effect == Effect::Rotation) {
      const BodyEffects body(scene);
      for (Index i = 0; i < c.bodies; ++i) c.turned += body.mayBeTurned(i);
    }
    scene.effects.set(effect, effects::need(effect, c).active);
  }
  scene.gravity_W = effects::isNeglected(Effect::Gravity, c) ? Vec3::Zero().eval() : scene.settings.gravity;
  const BodyEffects body(scene);
  for (Index i = 0; i < c.bodies; ++i) setRotation(scene, body, i);
  Rosters rosters = listBodies(scene, body);
  if (rosters.collidable != scene.rosters.collidable) {
    scene.sweep = {};
    scene.sweep.order = rosters.collidable;
  }
  c.ballistic = static_cast<Index>(rosters.ballistic.size());
  scene.rosters = std::move(rosters);
  scene.ballistic_until = scene.time;
  return c;
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

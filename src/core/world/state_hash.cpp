// SPDX-License-Identifier: BSD-3-Clause
#include "world/state_hash.h"

#include "state/scene_fields.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace rbs {

namespace {

// A word at a time: a multiplication carries a difference up, a shift brings it down. Both can be undone, so states
// that differ in one word have different hashes. (The factor and the shift are of splitmix64, G. Steele, D. Lea and
// C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.)
class Hash {
 public:
  template <class Number>
  void add(Number value) {
    static_assert(std::is_arithmetic_v<Number> && sizeof(Number) <= sizeof(std::uint64_t));
    std::uint64_t word = 0;
    std::memcpy(&word, &value, sizeof value);
    mix(word);
  }
  void add(const Vec3& v) { add(v.x()), add(v.y()), add(v.z()); }
  void add(const Pose& pose) { add(pose.p_WB), add(Vec3(pose.q_WB.vec())), add(pose.q_WB.w()); }
  void add(const std::string& text) {
    for (std::size_t k = 0; k < text.size(); k += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, text.data() + k, std::min(sizeof word, text.size() - k));
      mix(word);
    }
    add(text.size());
  }
  std::uint64_t value() const { return value_; }

 private:
  void mix(std::uint64_t word) {
    value_ = (value_ ^ word) * 0xbf58476d1ce4e5b9ull;
    value_ ^= value_ >> 27;
  }

  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

void addBody(Hash& hash, const Bodies& bodies, Index i) {
  const Traits& t = bodies.traits[i];
  hash.add(bodies.name[i]);
  hash.add(bodies.pose[i]);
  if (bodies.inertia[i].lazy_orientation && !bodies.twist[i].w_WB.isZero(0.0)) hash.add(bodies.since[i]);
  hash.add(bodies.twist[i].v_WB);
  hash.add(bodies.twist[i].w_WB);
  hash.add(t.shape.index());
  hash.add(fullExtents(t.shape));
  if (const auto* capsule = std::get_if<Capsule>(&t.shape)) hash.add(capsule->half_length);
  if (const auto* hull = std::get_if<ConvexHull>(&t.shape)) hash.add(hull->polyhedron->fingerprint);
  hash.add(static_cast<int>(t.kind));
  hash.add(t.held);
  hash.add(t.frozen);
  hash.add(t.mass);
  hash.add(t.material.friction);
  hash.add(t.material.restitution);
  hash.add(t.dragCoefficient());
  hash.add(t.material.rolling_resistance);
  hash.add(t.material.torsional_resistance);
  hash.add(t.group);
  hash.add(t.mask);
}

// What an absent surrounding hashes as: at least one of the numbers is one that no present surrounding has.
template <class Surrounding>
void addAbsent(Hash& hash, double Surrounding::*, const Range& range) {
  hash.add(range.low < 0.0 ? 0.0 : -1.0);
}
template <class Surrounding>
void addAbsent(Hash& hash, Vec3 Surrounding::*, const Range&) {
  hash.add(Vec3::Zero().eval());
}

void addSettings(Hash& hash, const SceneDef& settings) {
  hash.add(settings.gravity);
  hash.add(settings.step);
  hash.add(static_cast<int>(settings.fidelity.preset));
  hash.add(settings.fidelity.divisions);
  hash.add(settings.fidelity.sub_steps.value_or(0));
  hash.add(settings.fidelity.tolerance.value_or(0.0));
  hash.add(settings.fidelity.max_solve_ms.value_or(0.0));
  hash.add(settings.seed);
  forEachSurrounding([&](const char*, auto surrounding, auto type) {
    forEachField(type, [&](const char*, auto field, const Range& range) {
      if (const auto& given = settings.*surrounding) return hash.add(*given.*field);
      addAbsent(hash, field, range);
    });
  });
  for (const auto& [effect, on] : settings.effects) hash.add(static_cast<int>(effect)), hash.add(on);
}

}  // namespace

std::uint64_t bodyHash(const Bodies& bodies, Index i) {
  Hash hash;
  addBody(hash, bodies, i);
  return hash.value();
}

std::uint64_t stateHash(const SceneStore& scene) {
  Hash hash;
  addSettings(hash, scene.settings);
  hash.add(scene.time);
  hash.add(scene.steps);
  for (Index i = 0; i < scene.bodies.size(); ++i) addBody(hash, scene.bodies, i);
  for (Index i = 0; i < scene.rest.size(); ++i)
    if (scene.rest[i].steps > 0)
      hash.add(i), hash.add(scene.rest[i].steps), hash.add(scene.bodies.traits[i].asleep),
          hash.add(scene.rest[i].group);
  for (const TimedWrench& w : scene.wrenches)
    hash.add(scene.bodies.indexOf(w.body)), hash.add(w.force_W), hash.add(w.torque_W), hash.add(w.point_B),
        hash.add(w.until), hash.add(w.commanded);
  for (const BodyGrab& g : scene.grabs)
    hash.add(scene.bodies.indexOf(g.body)), hash.add(g.grab.p_B), hash.add(g.grab.p_W),
        hash.add(g.grab.frequency), hash.add(g.grab.max_acceleration);
  for (const BodyHold& h : scene.holds) hash.add(scene.bodies.indexOf(h.body)), hash.add(h.target);
  for (const Contact* contact : scene.contacts.withPoints()) {
    if (contact->points.empty()) continue;
    hash.add(scene.bodies.indexOf(contact->key.i)), hash.add(scene.bodies.indexOf(contact->key.j));
    hash.add(contact->exact), hash.add(contact->points.front().n_W), hash.add(contact->depth());
    for (const SolvedPoint& point : contact->points)
      hash.add(point.feature), hash.add(point.normal), hash.add(point.friction_W);
  }
  return hash.value();
}

}  // namespace rbs

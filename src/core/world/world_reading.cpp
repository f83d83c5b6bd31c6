// SPDX-License-Identifier: BSD-3-Clause
// What can be read of a world: its captures, sums and snapshots.
#include "world/world_parts.h"

#include "effects/effects.h"
#include "world/saved_state.h"
#include "world/state_hash.h"

#include <algorithm>
#include <map>

namespace rbs {

double World::time() const {
  return impl_->scene.time;
}
std::uint64_t World::steps() const {
  return impl_->scene.steps;
}
std::uint64_t World::edits() const {
  return impl_->edits;
}
std::uint64_t World::bodiesAnalysed() const {
  return impl_->scene.counts.looks;
}
const SceneDef& World::scene() const {
  return impl_->scene.settings;
}
std::vector<StageInfo> World::pipeline() const {
  return impl_->pipeline.describe(impl_->analysis, impl_->scene, impl_->step);
}
std::uint64_t World::stateHash() const {
  return rbs::stateHash(impl_->scene);
}

SceneDef World::capture() const {
  SceneDef scene = impl_->scene.settings;
  for (Index i = 0; i < impl_->scene.bodies.size(); ++i)
    scene.bodies.push_back(impl_->scene.bodies.define(i, impl_->scene.time));
  return scene;
}

SavedState World::captureState() const {
  return rbs::captureState(impl_->scene);
}

SavedState World::captureExactState() const {
  return rbs::captureExactState(impl_->scene);
}

Pose World::pose(BodyId id) const {
  return impl_->scene.bodies.poseNow(impl_->require(id), impl_->scene.time);
}

Totals World::totals() const {
  const Bodies& bodies = impl_->scene.bodies;
  const Vec3& gravity = impl_->scene.gravity_W;
  Totals sum;
  for (Index i = 0; i < bodies.size(); ++i) {
    const Traits& t = bodies.traits[i];
    if (t.kind != BodyKind::Dynamic || t.frozen) continue;
    const Pose pose = bodies.poseNow(i, impl_->scene.time);
    const Vec3& p = pose.p_WB;
    const Twist& twist = bodies.twist[i];
    const Vec3 w_B = pose.q_WB.conjugate() * twist.w_WB;
    const Vec3 l_B = bodies.inertia[i].moments.cwiseProduct(w_B);
    sum.kinetic_energy += 0.5 * (t.mass * twist.v_WB.squaredNorm() + l_B.dot(w_B));
    sum.potential_energy -= t.mass * gravity.dot(p);
    sum.momentum += t.mass * twist.v_WB;
    sum.angular_momentum += p.cross(t.mass * twist.v_WB) + pose.q_WB * l_B;
  }
  return sum;
}

std::shared_ptr<const std::vector<BodyDescription>> World::bodies() const {
  const Bodies& bodies = impl_->scene.bodies;
  if (!impl_->descriptions) {
    auto fresh = std::make_shared<std::vector<BodyDescription>>();
    for (Index i = 0; i < bodies.size(); ++i) fresh->push_back(bodies.describe(i));
    impl_->descriptions = std::move(fresh);
  }
  return impl_->descriptions;
}

namespace {

// The points at the end of the step and those that have opened in it, each with all that it has given in the
// step. What sleeps is held by the forces with which it fell asleep. Two points in one place are one, as
// where the lowest point of a rim passes a foot of it. Points of a loaded state have no places.
std::vector<ContactPoint> contactPoints(const SceneStore& scene) {
  std::vector<ContactPoint> points;
  for (const Contact* contact : scene.contacts.withPoints()) {
    std::vector<SolvedPoint> opened = contact->earlier;
    const auto first = static_cast<std::ptrdiff_t>(points.size());
    const std::uint64_t touching = contact->touchingSteps(scene.steps);
    const auto add = [&](const SolvedPoint& p) {
      const auto same = std::find_if(points.begin() + first, points.end(), [&](const ContactPoint& point) {
        return point.p_W == p.p_W && point.n_W == p.n_W && !p.p_W.isZero(0.0);
      });
      if (same == points.end()) {
        points.push_back({contact->key.i, contact->key.j, p.p_W, p.n_W, p.separation, p.normal_impulse,
                          p.friction_impulse_W, touching});
      } else {
        same->normal_impulse += p.normal_impulse;
        same->friction_impulse += p.friction_impulse_W;
      }
    };
    const bool asleep = scene.isAsleep(*contact);
    for (SolvedPoint point : contact->points) {
      if (asleep) {
        point.normal_impulse = point.normal * scene.settings.step;
        point.friction_impulse_W = point.friction_W * scene.settings.step;
      }
      const auto given = std::find_if(opened.begin(), opened.end(),
                                      [&](const SolvedPoint& p) { return p.feature == point.feature; });
      if (given != opened.end()) {
        if (!asleep) point.addImpulseOf(*given);  // those of what sleeps are of the whole step
        opened.erase(given);
      }
      add(point);
    }
    for (const SolvedPoint& point : opened) add(point);
  }
  return points;
}

// The states of all bodies, and what took each through the last step.
std::vector<BodyState> statesOf(const SceneStore& scene) {
  const Bodies& bodies = scene.bodies;
  std::vector<BodyState> states;
  states.reserve(bodies.size());
  for (Index i = 0; i < bodies.size(); ++i) {
    BodyState& state = states.emplace_back();
    state.id = bodies.id[i];
    state.pose = bodies.poseNow(i, scene.time);
    state.twist = bodies.twist[i];
    if (!bodies.traits[i].movable()) continue;
    state.method = bodies.advance[i].method;
    state.island = bodies.advance[i].island;
  }
  for (const Index i : scene.lists.ballistic) states[i].method = "ballistic", states[i].island = {};
  return states;
}

}  // namespace

std::vector<BodyState> World::states() const {
  return statesOf(impl_->scene);
}
std::vector<ContactPoint> World::contacts() const {
  return contactPoints(impl_->scene);
}

Snapshot World::snapshot() const {
  const Impl& w = *impl_;
  Snapshot s;
  s.scene = w.scene.settings.name;
  s.time = w.scene.time;
  s.steps = w.scene.steps;
  s.step = w.scene.settings.step;
  s.edits = w.edits;
  s.description_version = w.description_version;
  s.bodies = this->bodies();
  s.states = states();
  s.contacts = contacts();
  s.pipeline = pipeline();
  s.report = w.step.report;
  s.totals = totals();
  const SceneDef& settings = w.scene.settings;
  s.air.air = settings.air.has_value();
  s.air.wind = settings.wind.has_value();
  if (settings.air) s.air.density = settings.air->density;
  if (settings.wind) s.air.mean = settings.wind->velocity, s.air.gust = settings.wind->gust;
  s.air.velocity = airVelocity(settings, w.scene.time);
  s.fluid = settings.fluid;
  s.gravity = settings.gravity;
  s.effects = settings.effects;
  s.fidelity = settings.fidelity;
  s.goal = settings.goal;
  s.view = settings.view;
  s.hash = stateHash();
  return s;
}

int Snapshot::find(const std::string& name) const {
  for (std::size_t k = 0; bodies && k < bodies->size(); ++k)
    if ((*bodies)[k].name == name) return static_cast<int>(k);
  return -1;
}

int Snapshot::find(BodyId id) const {
  const auto it = std::lower_bound(states.begin(), states.end(), id,
                                   [](const BodyState& state, BodyId wanted) { return state.id < wanted; });
  return it != states.end() && it->id == id ? static_cast<int>(it - states.begin()) : -1;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "state/context.h"

#include "base/algebra.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

// The coefficient from which friction holds as good as everything: its cone is flat but for 1e-4 rad. With more, solvers lose
// the digits of the normal force.
constexpr double kMostFriction = 1e4;

}  // namespace

double SceneStore::frictionOf(Index i, Index j) const {
  if (!effects[Effect::Friction]) return 0.0;
  const double mean = std::sqrt(bodies.traits[i].material.friction * bodies.traits[j].material.friction);
  return std::min(mean, kMostFriction);
}

double SceneStore::restitutionOf(Index i, Index j) const {
  if (!effects[Effect::Restitution]) return 0.0;
  return std::max(bodies.traits[i].material.restitution, bodies.traits[j].material.restitution);
}

bool SceneStore::isAsleep(const Contact& contact) const {
  const Traits& a = bodies.traits[bodies.indexOf(contact.key.i)];
  const Traits& b = bodies.traits[bodies.indexOf(contact.key.j)];
  return (a.asleep || b.asleep) && !a.moved_by_forces() && !b.moved_by_forces();
}

void StepStore::begin(const SceneStore& scene, double from, double to) {
  const bool ballistic_only =
      scene.lists.in_islands.empty() && scene.lists.kinematic.empty() && scene.lists.collidable.empty();
  const std::size_t n = ballistic_only ? 0 : scene.bodies.size();
  t0 = from;
  t1 = to;
  solver = resolved(scene.settings.fidelity);
  load.assign(n, {});
  load_without_drag.clear();
  submerged.clear();
  bounds.resize(n);
  supported.assign(n, 0);
  touched.assign(n, 0);
  crowded.clear();
  impacts.clear();
  stamp.assign(n, 0);
  last_impact.resize(n);
  impacted.clear();
  reached.clear();
  overlapping.clear(), disturbed.clear();
  islands.clear();
  moving_pairs = 0;
  island.assign(n, kNone);
  slot.assign(n, kNone);
  woken.clear();
  falling_asleep.clear();
  before.assign(scene.bodies.pose.begin(), scene.bodies.pose.begin() + static_cast<std::ptrdiff_t>(n));
  twist_before.assign(scene.bodies.twist.begin(),
                      scene.bodies.twist.begin() + static_cast<std::ptrdiff_t>(n));
  report = {};
}

Pose StepStore::poseAt(const Bodies& bodies, Index i, double t) const {
  Pose pose = bodies.pose[i];
  if (island[i] != kNone || !bodies.traits[i].is_kinematic() || t == t0) return pose;
  pose.p_WB += (t - t0) * bodies.twist[i].v_WB;
  pose.q_WB = (rotationBy((t - t0) * bodies.twist[i].w_WB) * pose.q_WB).normalized();
  return pose;
}

double orEarths(double gravity) {
  constexpr double kEarth = 9.81;
  return gravity > 0.0 ? gravity : kEarth;
}

double fallSpeed(double gravity, double length) {
  return std::sqrt(orEarths(gravity) * length);
}

}  // namespace rbs

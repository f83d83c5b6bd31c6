// SPDX-License-Identifier: BSD-3-Clause
#include "solver/contact_preparation.h"

#include "narrowphase/collide.h"
#include "narrowphase/same_side.h"

#include <algorithm>
#include <limits>

namespace rbs {

namespace {

// Share of the smaller length above which a step is one, however soft contacts are.
constexpr double kMostFlush = 0.05;
// Share of the weight of the lighter body that makes a force of a contact.
constexpr double kLoaded = 1e-3;
// Share of the closing of a contact up to which another normal counts as one along which nothing closes.
constexpr double kExactClosing = 1e-6, kSoftClosing = 0.1;
// Share of the speed that a load adds in a step below which a soft contact is at rest.
constexpr double kSoftRest = 1e-3;
// Share of the smaller length from which on an overlap is no rounding of a pair that has gone round to another side.
constexpr double kDeepSide = 1e-3;

}  // namespace

double smallerLength(const Bodies& bodies, Index i, Index j) {
  return std::min(bodies.traits[i].length, bodies.traits[j].length);
}

PairConstants pairConstants(const Context& context, Index i, Index j) {
  const SceneStore& scene = context.scene;
  PairConstants pair;
  pair.length = smallerLength(scene.bodies, i, j);
  pair.mu = scene.frictionOf(i, j);
  pair.e = scene.restitutionOf(i, j);
  pair.load = std::max(scene.gravity_W.norm(), (context.step.load[j].a_W - context.step.load[i].a_W).norm());
  const double mass = 1.0 / std::max(scene.bodies.inertia[i].inv_mass, scene.bodies.inertia[j].inv_mass);
  pair.carried = context.step.supported[i] || context.step.supported[j];
  pair.bears = kLoaded * mass * pair.load;
  pair.push = fallSpeed(pair.load, pair.length);
  return pair;
}

double slowestRebound(const Context& context, const Vec3& n_W) {
  const Vec3& g_W = context.scene.gravity_W;
  return 0.5 * context.step.h() * std::max(std::abs(n_W.dot(g_W)), kAcross * g_W.norm());
}

double reachOf(const Traits& body, const Traits& other, const Vec3& p_W, const Vec3& u_W, double time) {
  if (body.round) return 0.0;
  if (body.unbounded) return p_W.norm() + time * u_W.norm() + other.bounding_radius;
  return body.bounding_radius;
}

LastingLimits exactLimits(const StepStore& step, const PairConstants& pair) {
  return {kTouch * pair.length, step.solver.tolerance * pair.load * step.h(), kExactClosing};
}

double sag(const PairConstants& pair, double h) {
  return pair.load * (h / kStiffness) * (h / kStiffness);
}

LastingLimits softLimits(const StepStore& step, const PairConstants& pair, double h) {
  const double sunk = pair.carried ? kMargin * pair.length + 2.0 * sag(pair, h) : kTouch * pair.length;
  return {std::min(sunk, kMostFlush * pair.length), kSoftRest * pair.load * step.h(), kSoftClosing};
}

Manifold contactManifold(const Bodies& bodies, Index i, const Motion& trajectory_i, Index j,
                         const Motion& trajectory_j, double from, double until, double margin,
                         const LastingLimits& limits, const LastNormal& last, SeparatingAxis& axis) {
  const Traits &a = bodies.traits[i], &b = bodies.traits[j];
  const bool bounded = !a.unbounded && !b.unbounded;
  // Only what has faces and an end has joints.
  Manifold manifold =
      bounded && (a.edged || b.edged)
          ? lastingManifold(a.shape, trajectory_i, b.shape, trajectory_j, from, until, margin, limits,
                            last.loaded ? last.n_W : Vec3::Zero(), axis)
          : collide(a.shape, trajectory_i.at(from), b.shape, trajectory_j.at(from), margin, axis);
  const bool turned = manifold.size > 0 && bounded && last.n_W.dot(manifold.n_W) < 0.0;
  if (turned && leastSeparation(manifold) < -kDeepSide * std::min(a.length, b.length))
    manifold =
        manifoldOnSide(last.n_W, a.shape, trajectory_i.at(from), b.shape, trajectory_j.at(from), margin);
  return manifold;
}

double searchMargin(const Contact& contact, double margin) {
  return contact.state.isMissed() ? std::numeric_limits<double>::infinity() : margin;
}

bool areApart(const Context& context, const std::vector<Index>& contacts) {
  const std::vector<Traits>& traits = context.scene.bodies.traits;
  return std::none_of(contacts.begin(), contacts.end(), [&](Index k) {
    const Contact& contact = context.scene.contacts.active[k];
    const bool is_known = context.scene.steps > 0 || !contact.points.empty();
    return traits[contact.i].moved_by_forces() && traits[contact.j].moved_by_forces() &&
           (!is_known || contact.bears() || contact.state.isTouching());
  });
}

}  // namespace rbs

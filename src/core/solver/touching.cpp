// SPDX-License-Identifier: BSD-3-Clause
#include "solver/touching.h"

#include "base/algebra.h"
#include "base/tolerances.h"
#include "effects_built.h"
#include "narrowphase/collide.h"
#include "solver/rolling.h"

#include <algorithm>

namespace rbs {

namespace {

// How fast a point of the surface moves because the body turns.
double surfaceSpeed(const Bodies& bodies, Index i) {
  const Traits& t = bodies.traits[i];
  return t.round || t.unbounded ? 0.0 : t.bounding_radius * bodies.twist[i].w_WB.norm();
}

Vec3 velocityAt(const Twist& twist, const Vec3& r) {
  return twist.v_WB + twist.w_WB.cross(r);
}

// The couple of a contact whose points have just been found, from the `first` on; none where it resists
// nothing.
void addCouple(const Context& context, Index contact, std::size_t first, Touching& out) {
  const SceneStore& scene = context.scene;
  const Index i = scene.contacts.active[contact].i, j = scene.contacts.active[contact].j;
  if (first == out.law.size() || !rolling::resists(scene, i, j)) return;
  const CoulombPoint& point = out.law[first];
  const auto turns = [&](Index slot, Index body) {
    return slot != kNone && !scene.bodies.inertia[body].steady;
  };
  CoulombCouple law;
  law.radius = rolling::radius(scene.bodies, i, j, point.frame.col(2));
  if (law.radius == 0.0 || !(turns(point.i, i) || turns(point.j, j))) return;
  const Material &a = scene.bodies.traits[i].material, &b = scene.bodies.traits[j].material;
  law.i = point.i, law.j = point.j;
  law.first = static_cast<Index>(first), law.size = static_cast<Index>(out.law.size() - first);
  law.frame = point.frame;
  law.roll = a.rolling_resistance + b.rolling_resistance;
  law.spin = a.torsional_resistance + b.torsional_resistance;
  Vec3 led_W = Vec3::Zero();
  if (law.j == kNone) led_W += scene.bodies.twist[j].w_WB;
  if (law.i == kNone) led_W -= scene.bodies.twist[i].w_WB;
  law.drive = law.radius * (law.frame.transpose() * led_W);
  out.couples.push_back({contact, law});
}

}  // namespace

Touching findTouching(const Context& context, const std::vector<Index>& active, const Slots& slots,
                      double time, double span, double reach) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  const double gravity = context.scene.gravity_W.norm();
  Touching out;
  out.points.reserve(4 * active.size());
  out.law.reserve(4 * active.size());
  for (const Index k : active) {
    const Contact& contact = context.scene.contacts.active[k];
    if (!contact.state.isSolved()) continue;
    const Index i = contact.i, j = contact.j;
    const Traits &a = bodies.traits[i], &b = bodies.traits[j];
    const Pose X_i = step.poseAt(bodies, i, time), X_j = step.poseAt(bodies, j, time);
    const double length = std::min(a.length, b.length);
    const double speed = (bodies.twist[j].v_WB - bodies.twist[i].v_WB).norm() + surfaceSpeed(bodies, i) +
                         surfaceSpeed(bodies, j) + 0.5 * span * (step.load[j].a_W - step.load[i].a_W).norm();
    const Manifold manifold = collide(a.shape, X_i, b.shape, X_j, reach * (span * speed + kMargin * length));
    const auto [t1, t2] = tangents(manifold.n_W);
    const std::size_t first = out.law.size();
    for (int p = 0; p < manifold.size; ++p) {
      const ManifoldPoint& found = manifold.points[p];
      CoulombPoint law;
      law.i = slots[i], law.j = slots[j];
      law.r_i = found.p_W - X_i.p_WB, law.r_j = found.p_W - X_j.p_WB;
      law.frame << t1, t2, manifold.n_W;
      law.mu = context.scene.frictionOf(i, j);
      Vec3 led_W = Vec3::Zero();
      if (law.j == kNone) led_W += velocityAt(bodies.twist[j], law.r_j);
      if (law.i == kNone) led_W -= velocityAt(bodies.twist[i], law.r_i);
      law.drive = law.frame.transpose() * led_W;
      out.points.push_back(
          {k, found.feature, found.separation, length, fallSpeed(gravity, length), found.p_W, law.drive});
      out.law.push_back(law);
    }
    if constexpr (built::rolling)
      if (context.scene.effects[Effect::Rolling]) addCouple(context, k, first, out);
  }
  return out;
}

Index Touching::matching(const TouchingPoint& other) const {
  auto p = std::lower_bound(points.begin(), points.end(), other.contact,
                            [](const TouchingPoint& point, Index k) { return point.contact < k; });
  for (; p != points.end() && p->contact == other.contact; ++p)
    if (p->feature == other.feature) return static_cast<Index>(p - points.begin());
  return kNone;
}

bool Touching::has(Index contact) const {
  const auto p = std::lower_bound(points.begin(), points.end(), contact,
                                  [](const TouchingPoint& point, Index k) { return point.contact < k; });
  return p != points.end() && p->contact == contact;
}

Index Touching::matching(const TouchingCouple& other) const {
  const auto c = std::lower_bound(couples.begin(), couples.end(), other.contact,
                                  [](const TouchingCouple& couple, Index k) { return couple.contact < k; });
  return c != couples.end() && c->contact == other.contact ? static_cast<Index>(c - couples.begin()) : kNone;
}

SolvedPoint solvedPoint(const TouchingPoint& point, const Vec3& n_W) {
  SolvedPoint solved;
  solved.feature = point.feature;
  solved.p_W = point.p_W;
  solved.n_W = n_W;
  solved.separation = point.gap;
  solved.setImpulse(point.impulse_W);
  return solved;
}

void Touching::inherit(const Touching& other, PointsOfContacts& opened) {
  for (TouchingPoint& point : points) {
    const Index m = other.matching(point);
    if (m == kNone) continue;
    point.force_W = other.points[m].force_W;
    point.impulse_W = other.points[m].impulse_W;
  }
  for (TouchingCouple& couple : couples) {
    const Index m = other.matching(couple);
    if (m != kNone) couple.force_W = other.couples[m].force_W;
  }
  for (std::size_t k = 0; k < other.points.size(); ++k)
    if (!other.points[k].impulse_W.isZero(0.0) && matching(other.points[k]) == kNone)
      opened.emplace_back(other.points[k].contact, solvedPoint(other.points[k], other.law[k].frame.col(2)));
}

void expectLastForces(const Contacts& contacts, Touching& touching) {
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    TouchingPoint& point = touching.points[k];
    const Vec3 n_W = touching.law[k].frame.col(2);
    for (const SolvedPoint& last : contacts.active[point.contact].points)
      if (last.feature == point.feature)
        point.force_W = last.friction_W + (last.normal - n_W.dot(last.friction_W)) * n_W;
  }
}

void storeTouching(const Touching& touching, const PointsOfContacts& opened, const std::vector<Index>& active,
                   Contacts& contacts) {
  for (const Index k : active) contacts.active[k].beginSolve(), contacts.active[k].exact = true;
  for (const auto& [k, point] : opened) contacts.active[k].addEarlier(point);
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    const TouchingPoint& point = touching.points[k];
    const Vec3 n_W = touching.law[k].frame.col(2);
    SolvedPoint solved = solvedPoint(point, n_W);
    solved.normal = std::max(point.force_W.dot(n_W), 0.0);
    solved.friction_W = point.force_W - point.force_W.dot(n_W) * n_W;
    contacts.active[point.contact].points.push_back(solved);
  }
}

}  // namespace rbs

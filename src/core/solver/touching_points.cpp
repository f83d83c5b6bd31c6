// SPDX-License-Identifier: BSD-3-Clause
#include "solver/touching_points.h"

#include "base/algebra.h"
#include "base/tolerances.h"
#include "effects_built.h"
#include "solver/contact_preparation.h"
#include "solver/rolling.h"

#include <algorithm>
#include <limits>

namespace rbs {

namespace {

// The torque constraint of a contact whose points have just been found, from the `first` on; none where it resists
// nothing.
void addTorque(const Context& context, Index contact, std::size_t first, TouchingPoints& out) {
  const SceneStore& scene = context.scene;
  const Index i = scene.contacts.active[contact].i, j = scene.contacts.active[contact].j;
  if (first == out.law.size() || !rolling::resists(scene, i, j)) return;
  const CoulombPoint& point = out.law[first];
  const auto turns = [&](Index slot, Index body) {
    return slot != kNone && !scene.bodies.inertia[body].steady;
  };
  TorqueConstraint law;
  law.radius = rolling::radius(scene.bodies, i, j, point.frame.col(2));
  if (law.radius == 0.0 || !(turns(point.i, i) || turns(point.j, j))) return;
  law.i = point.i, law.j = point.j;
  law.first = static_cast<Index>(first), law.size = static_cast<Index>(out.law.size() - first);
  law.frame = point.frame;
  const auto [roll, spin] = rolling::coefficients(scene, i, j);
  law.roll = roll, law.spin = spin;
  Vec3 prescribed_W = Vec3::Zero();
  if (law.j == kNone) prescribed_W += scene.bodies.twist[j].w_WB;
  if (law.i == kNone) prescribed_W -= scene.bodies.twist[i].w_WB;
  law.bias = law.radius * (law.frame.transpose() * prescribed_W);
  out.torques.push_back({contact, law});
}

}  // namespace

TouchingPoints findTouching(const Context& context, const std::vector<Index>& active, const Slots& slots,
                            double time, double span, double reach, const LastNormals& last) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  TouchingPoints out;
  out.points.reserve(4 * active.size());
  out.law.reserve(4 * active.size());
  for (const Index k : active) {
    const Contact& contact = context.scene.contacts.active[k];
    if (!contact.state.isForSolver()) continue;
    const Index i = contact.i, j = contact.j;
    const Traits &a = bodies.traits[i], &b = bodies.traits[j];
    const Pose X_i = step.poseAt(bodies, i, time), X_j = step.poseAt(bodies, j, time);
    const Twist &twist_i = bodies.twist[i], &twist_j = bodies.twist[j];
    const PairConstants pair = pairConstants(context, i, j);
    const Vec3 p_W = X_j.p_WB - X_i.p_WB, u_W = twist_j.v_WB - twist_i.v_WB;
    const double near =
        approach(span, u_W, reachOf(a, b, p_W, u_W, span) * twist_i.w_WB.norm(),
                 reachOf(b, a, p_W, u_W, span) * twist_j.w_WB.norm(), step.load[j].a_W - step.load[i].a_W);
    const Manifold manifold =
        contactManifold(bodies, i, {time, X_i, twist_i}, j, {time, X_j, twist_j}, time, time + span,
                        searchMargin(contact, reach * (near + kMargin * pair.length)),
                        exactLimits(step, pair), last.of(k, contact, pair.bears), contact.axis);
    const auto [t1, t2] = tangents(manifold.n_W);
    const double rebounds_from = pair.e > 0.0 && contact.isFresh()
                                     ? step.solver.slowest_impact * step.h() * pair.load
                                     : std::numeric_limits<double>::infinity();
    const std::size_t first = out.law.size();
    for (int p = 0; p < manifold.size; ++p) {
      const ManifoldPoint& found = manifold.points[p];
      CoulombPoint law;
      law.i = slots[i], law.j = slots[j];
      law.r_i = found.p_W - X_i.p_WB, law.r_j = found.p_W - X_j.p_WB;
      law.frame << t1, t2, manifold.n_W;
      if (law.i == kNone) law.axis_W = bodies.axis_W(j);
      if (law.j == kNone) law.axis_W = bodies.axis_W(i);
      law.mu = pair.mu;
      Vec3 prescribed_W = Vec3::Zero();
      if (law.j == kNone) prescribed_W += velocityAt(twist_j, law.r_j);
      if (law.i == kNone) prescribed_W -= velocityAt(twist_i, law.r_i);
      law.bias = law.frame.transpose() * prescribed_W;
      out.points.push_back(
          {k, found.feature, found.separation, pair.length, pair.push, rebounds_from, found.p_W});
      out.law.push_back(law);
    }
    if constexpr (built::rolling)
      if (context.scene.effects[Effect::Rolling]) addTorque(context, k, first, out);
  }
  return out;
}

Index TouchingPoints::matching(const TouchingPoint& other) const {
  for (std::size_t p = firstOf(other.contact); p < points.size() && points[p].contact == other.contact; ++p)
    if (points[p].feature == other.feature) return static_cast<Index>(p);
  return kNone;
}

std::size_t TouchingPoints::firstOf(Index contact) const {
  const auto p = std::lower_bound(points.begin(), points.end(), contact,
                                  [](const TouchingPoint& point, Index k) { return point.contact < k; });
  return p != points.end() && p->contact == contact ? static_cast<std::size_t>(p - points.begin())
                                                    : points.size();
}

void TouchingPoints::add(const TouchingPoint& point, const CoulombPoint& its_law) {
  const auto next =
      std::upper_bound(points.begin(), points.end(), point.contact,
                       [](Index contact, const TouchingPoint& other) { return contact < other.contact; });
  law.insert(law.begin() + (next - points.begin()), its_law);
  points.insert(next, point);
  for (TouchingTorque& torque : torques) {
    if (torque.contact == point.contact) ++torque.law.size;
    if (torque.contact > point.contact) ++torque.law.first;
  }
}

TouchingPoints TouchingPoints::without(const std::vector<Index>& left_out) const {
  TouchingPoints rest;
  const auto isLeftOut = [&](Index k) { return std::binary_search(left_out.begin(), left_out.end(), k); };
  for (Index k = 0; k < points.size(); ++k)
    if (!isLeftOut(k)) rest.points.push_back(points[k]), rest.law.push_back(law[k]);
  for (TouchingTorque torque : torques) {
    const Index end = torque.law.first + torque.law.size;
    const auto placeOf = [&](Index k) {
      return k - static_cast<Index>(std::lower_bound(left_out.begin(), left_out.end(), k) - left_out.begin());
    };
    torque.law.first = placeOf(torque.law.first), torque.law.size = placeOf(end) - torque.law.first;
    if (torque.law.size > 0) rest.torques.push_back(torque);
  }
  return rest;
}

LastNormal LastNormals::of(Index k, const Contact& contact, double least) const {
  if (touching == nullptr || !touching->has(k)) return contact.lastNormal(least);
  LastNormal last;
  for (std::size_t p = touching->firstOf(k); p < touching->points.size() && touching->points[p].contact == k;
       ++p) {
    const bool loads = (*law)[p].impulse[2] > seconds * least;
    if ((loads && !last.loaded) || (touching->points[p].gap < 0.0 && last.n_W.isZero(0.0)))
      last = {(*law)[p].frame.col(2), loads};
  }
  return last;
}

Index TouchingPoints::matching(const TouchingTorque& other) const {
  const auto c = std::lower_bound(torques.begin(), torques.end(), other.contact,
                                  [](const TouchingTorque& torque, Index k) { return torque.contact < k; });
  return c != torques.end() && c->contact == other.contact ? static_cast<Index>(c - torques.begin()) : kNone;
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

SolvedPoint openedPoint(const TouchingPoint& point, const Vec3& n_W) {
  SolvedPoint opened = solvedPoint(point, n_W);
  opened.separation = std::max(opened.separation, 0.0);
  return opened;
}

void TouchingPoints::inherit(const TouchingPoints& other, PointsOfContacts& opened) {
  for (TouchingPoint& point : points) {
    const Index m = other.matching(point);
    if (m == kNone) continue;
    point.force_W = other.points[m].force_W;
    point.impulse_W = other.points[m].impulse_W;
  }
  for (TouchingTorque& torque : torques) {
    const Index m = other.matching(torque);
    if (m != kNone) torque.force_W = other.torques[m].force_W;
  }
  for (std::size_t k = 0; k < other.points.size(); ++k)
    if (!other.points[k].impulse_W.isZero(0.0) && matching(other.points[k]) == kNone)
      opened.emplace_back(other.points[k].contact, openedPoint(other.points[k], other.law[k].frame.col(2)));
}

void expectLastForces(const Contacts& contacts, TouchingPoints& touching) {
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    TouchingPoint& point = touching.points[k];
    const Vec3 n_W = touching.law[k].frame.col(2);
    if (const SolvedPoint* last = contacts.active[point.contact].pointOf(point.feature))
      point.force_W = last->friction_W + (last->normal - n_W.dot(last->friction_W)) * n_W;
  }
}

void storeTouching(const TouchingPoints& touching, const PointsOfContacts& opened,
                   const std::vector<Index>& active, Contacts& contacts) {
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

// SPDX-License-Identifier: BSD-3-Clause
#include "step/depenetration.h"

#include "base/text.h"
#include "base/tolerances.h"
#include "effects/effects.h"
#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"

#include <algorithm>
#include <cmath>

namespace rbs::depenetration {

namespace {

// Two balls inscribed in the bodies that overlap by this share of their radii tell a deep overlap without a
// look at the shapes.
constexpr double kInscribed = 0.5;
// Bodies that overlap no more others than this are left to the contact solver, which parts them by the
// shortest way.
constexpr Index kFew = 3;
// Deep pairs of an island that the exact settings still solve exactly. A pyramid of ten boxes that overlap by
// half has 18, and parts best so; what is left of a crowd of 200 boxes has hundreds, which take too long.
constexpr Index kFewToSolve = 32;
// Offset that tells bodies with one centre apart, share of their length.
constexpr double kNudge = 1e-3;

// By how much the balls inscribed in two bodies overlap, m; negative when they are apart.
double inscribedOverlap(const Bodies& bodies, const Contact& contact) {
  return innerRadius(bodies.traits[contact.i].shape) + innerRadius(bodies.traits[contact.j].shape) -
         (bodies.pose[contact.i].p_WB - bodies.pose[contact.j].p_WB).norm();
}

// Surely, without a look at the shapes.
bool shareACentre(const Bodies& bodies, const Contact& contact) {
  const double radii =
      innerRadius(bodies.traits[contact.i].shape) + innerRadius(bodies.traits[contact.j].shape);
  return inscribedOverlap(bodies, contact) > kInscribed * radii;
}

bool areMovable(const Bodies& bodies, const Contact& contact) {
  return bodies.traits[contact.i].moved_by_forces() && bodies.traits[contact.j].moved_by_forces();
}

// Places that fill a disc evenly (H. Vogel, "A better way to construct the sunflower head", Math. Biosci. 44,
// 1979), by the index of a body, which outlives a save: where bodies with one centre are taken to be.
Vec3 placeOnDisc(Index i) {
  constexpr double kGolden = 2.399963229728653;  // rad
  const double k = static_cast<double>(i % 4096);
  return std::sqrt(k / 4096.0) * Vec3(std::cos(kGolden * k), std::sin(kGolden * k), 0.0);
}

// Which way is up: crowds part across it.
Vec3 upOf(const SceneStore& scene) {
  return scene.gravity_W.isZero(0.0) ? Vec3::UnitZ() : Vec3(-scene.gravity_W.normalized());
}

// What remains of a body's way where something that forces do not move, and that it touches, is in it.
void keepOut(const Context& context, std::vector<Vec3>& ways) {
  const Bodies& bodies = context.scene.bodies;
  for (const Contact& contact : context.scene.contacts.active) {
    if (areMovable(bodies, contact)) continue;
    const bool first = bodies.traits[contact.i].moved_by_forces();
    Vec3& way = ways[first ? contact.i : contact.j];
    for (const SolvedPoint& point : contact.points) {
      const Vec3 n_W = (first ? 1.0 : -1.0) * point.n_W;
      way -= std::max(0.0, n_W.dot(way)) * n_W;
    }
  }
}

// The way of each body of a crowd: the mean of those away from the bodies that it overlaps, the heavier one
// of a pair going less far. No longer than what the body may go in the step.
std::vector<Vec3> waysApart(const Context& context, const std::vector<Contact*>& crowded) {
  const Bodies& bodies = context.scene.bodies;
  const Vec3 up = upOf(context.scene);
  const double gravity = context.scene.gravity_W.norm();
  const Mat3 across = Mat3::Identity() - up * up.transpose();
  const Quat upright = Quat::FromTwoVectors(Vec3::UnitZ(), up);
  std::vector<Vec3> ways(bodies.size(), Vec3::Zero());
  std::vector<Index> others(bodies.size(), 0);
  for (const Contact* crowding : crowded) {
    const Contact& contact = *crowding;
    const double length = smallerLength(bodies, contact.i, contact.j);
    const Vec3 nudge = kNudge * length * (upright * (placeOnDisc(contact.j) - placeOnDisc(contact.i)));
    const Vec3 offset = across * (bodies.pose[contact.j].p_WB - bodies.pose[contact.i].p_WB) + nudge;
    if (offset.isZero(0.0)) continue;
    const Vec3 way = context.step.h() * fallSpeed(gravity, length) * offset.normalized();
    const double m_i = bodies.traits[contact.i].mass, m_j = bodies.traits[contact.j].mass;
    ways[contact.i] -= m_j / (m_i + m_j) * way;
    ways[contact.j] += m_i / (m_i + m_j) * way;
    ++others[contact.i], ++others[contact.j];
  }
  for (Index i = 0; i < bodies.size(); ++i)
    if (others[i] > 0) ways[i] /= others[i];
  keepOut(context, ways);
  return ways;
}

// Keeps how deep a pair of a crowd is, for the next step and for readers: the forces are none.
void keepDepth(const Bodies& bodies, Contact& contact) {
  SolvedPoint point;
  if (shareACentre(bodies, contact)) {
    point.feature = SolvedPoint::kNoSide;
    point.separation = -inscribedOverlap(bodies, contact);
    point.p_W = 0.5 * (bodies.pose[contact.i].p_WB + bodies.pose[contact.j].p_WB);
  } else {
    const Manifold manifold = collide(bodies.traits[contact.i].shape, bodies.pose[contact.i],
                                      bodies.traits[contact.j].shape, bodies.pose[contact.j], 0.0);
    point.n_W = manifold.n_W;
    for (int p = 0; p < manifold.size; ++p)
      if (manifold.points[p].separation < point.separation)
        point.separation = manifold.points[p].separation, point.p_W = manifold.points[p].p_W;
  }
  contact.beginSolve();
  contact.exact = false;
  if (point.separation < 0.0) contact.points.push_back(point);
}

// An edit that moves or reshapes a body forgets its contacts, so their pairs had no points when the step began. An overlap may be
// gone when it ends.
void warn(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  const auto overlapAtStart = [&](Index i, Index j) {
    return -gap(bodies.traits[i].shape, context.step.before[i], bodies.traits[j].shape,
                context.step.before[j])
                .distance;
  };
  std::vector<Index> deep;
  for (const Contact& contact : context.scene.contacts.active)
    if (contact.solved && contact.points_before.empty() &&
        overlapAtStart(contact.i, contact.j) > kDeep * smallerLength(bodies, contact.i, contact.j))
      for (const Index i : {contact.i, contact.j})
        if (bodies.traits[i].moved_by_forces()) deep.push_back(i);
  std::sort(deep.begin(), deep.end());
  deep.erase(std::unique(deep.begin(), deep.end()), deep.end());
  if (deep.empty()) return;
  context.step.report.warnings.push_back(
      {"overlap",
       count(static_cast<Index>(deep.size()), "body overlaps", "bodies overlap") +
           " others deeply after an edit, the first of them '" + bodies.name[deep.front()] +
           "'; they are moved apart without gaining speed. Undo the edit, or leave room between bodies"});
}

}  // namespace

bool isDeep(const Context& context, const Contact& contact) {
  const Bodies& bodies = context.scene.bodies;
  return shareACentre(bodies, contact) ||
         contact.depth() > kDeep * smallerLength(bodies, contact.i, contact.j);
}

Need need(const SceneAnalysis& c) {
  if (c.moved_by_forces == 0 || !effects::need(Effect::Collision, c).active)
    return {false, "no two bodies can overlap"};
  return {true, "edits may put bodies where others are"};
}

void find(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  std::vector<Contact*> deep;
  for (Contact& contact : context.scene.contacts.active)
    if (areMovable(bodies, contact) && isDeep(context, contact)) deep.push_back(&contact);
  if (deep.size() <= kFew) return;
  std::vector<Index> others(bodies.size(), 0);
  for (const Contact* contact : deep) ++others[contact->i], ++others[contact->j];
  for (Contact* contact : deep) {
    if (std::min(others[contact->i], others[contact->j]) <= kFew) continue;
    contact->state.depenetrate();
    step.crowded.resize(bodies.size(), 0);
    step.crowded[contact->i] = step.crowded[contact->j] = 1;
  }
}

bool rulesOver(const Context& context, const Island& island) {
  const StepStore& step = context.step;
  if (std::any_of(island.bodies.begin(), island.bodies.end(), [&](Index i) { return step.isCrowded(i); }))
    return true;
  const auto overlaps = [&](Index k) { return isDeep(context, context.scene.contacts.active[k]); };
  return std::count_if(island.contacts.begin(), island.contacts.end(), overlaps) > kFewToSolve;
}

void separate(Context& context) {
  std::vector<Contact*> crowded;
  for (Contact& contact : context.scene.contacts.active)
    if (contact.state.isDepenetrating()) crowded.push_back(&contact);
  if (!crowded.empty()) {
    const std::vector<Vec3> ways = waysApart(context, crowded);
    for (const Index i : context.scene.lists.in_islands) context.scene.bodies.pose[i].p_WB += ways[i];
    for (Contact* contact : crowded) keepDepth(context.scene.bodies, *contact);
  }
  if (context.scene.just_edited) warn(context);
}

}  // namespace rbs::depenetration

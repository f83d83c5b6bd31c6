// SPDX-License-Identifier: BSD-3-Clause
#include "step/missed_contacts.h"

#include "base/algebra.h"
#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"
#include "step/paths.h"

#include <algorithm>
#include <optional>
#include <tuple>

namespace rbs {

namespace {

// Overlaps, shares of the smaller length. Below kMissed there is none. Up to kSoftLimit contacts part the two in the next step,
// on the side from which they came; up to kReboundLimit an impact does.
constexpr double kMissed = 1e-7, kSoftLimit = 0.1, kReboundLimit = 0.5;
// Share of its length by which a body may leave the bounds of its predicted motion.
constexpr double kDeviation = 0.02;

// Pairs that the solver has looked at.
struct SolvedPairs {
  explicit SolvedPairs(const Contacts& contacts) {
    for (const Contact& contact : contacts.active) {
      const PairState& state = contact.state;
      const std::pair pair(contact.i, contact.j);
      if (state.isMissed() || state.isDepenetrating() || (state.isForSolver() && !contact.points.empty()))
        with_points.push_back(pair);
      else if (state.isForSolver())
        without.push_back(pair);
    }
    std::sort(with_points.begin(), with_points.end());
    std::sort(without.begin(), without.end());
  }
  IndexPairs with_points;  // and those that no solve is to look at
  IndexPairs without;      // none of their points could close
};

bool isAmong(const IndexPairs& sorted, const std::pair<Index, Index>& pair) {
  return std::binary_search(sorted.begin(), sorted.end(), pair);
}

// Whether an overlap may wait: an impact in the next step gives the pair the rebound that contact would take.
bool awaitsRebound(const Context& context, Index i, Index j) {
  return context.step.solver.exact && context.scene.restitutionOf(i, j) > 0.0;
}

// The overlap that the next step takes care of, m.
double mostLeft(const Context& context, Index i, Index j) {
  return (awaitsRebound(context, i, j) ? kReboundLimit : kSoftLimit) *
         smallerLength(context.scene.bodies, i, j);
}

double overlapAt(const Context& context, Index i, Index j, double time) {
  const Bodies& bodies = context.scene.bodies;
  return -gap(bodies.traits[i].shape, context.step.poseAt(bodies, i, time), bodies.traits[j].shape,
              context.step.poseAt(bodies, j, time))
              .distance;
}

// The straight way of a body to where it has ended the step, from where it began it or an impact changed its trajectory last.
Motion pathOf(const Context& context, Index i) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  Motion way;
  way.t0 = step.t0;
  way.pose = bodies.pose[i];
  way.twist = bodies.twist[i];
  if (step.island[i] == kNone) return way;
  way.pose = step.before[i];
  if (step.stamp[i] > 0) std::tie(way.t0, way.pose) = step.last_impact[i];
  return step.t1 > way.t0 ? Motion::between(way.t0, way.pose, step.t1, bodies.pose[i]) : way;
}

// Whether two bodies met on their ways and went on into each other, perhaps out on the other side.
bool havePassed(const Context& context, Index i, Index j) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  const Shape &a = bodies.traits[i].shape, &b = bodies.traits[j].shape;
  const Motion path_i = pathOf(context, i), path_j = pathOf(context, j);
  const auto met = impactOnPaths(a, path_i, b, path_j, std::max(path_i.t0, path_j.t0), step.t1);
  return met && met->beyond > mostLeft(context, i, j);
}

// Whether the exact step solved all that is in contact with two bodies: then no overlap is left but what it has not seen.
bool areExact(const Context& context, Index i, Index j) {
  const StepStore& step = context.step;
  const auto isSolved = [&](Index k) {
    return step.island[k] == kNone || step.islands[step.island[k]].exact;
  };
  return step.solver.exact && isSolved(i) && isSolved(j);
}

bool isMissed(const Context& context, const SolvedPairs& solved, const std::pair<Index, Index>& pair) {
  if (isAmong(solved.with_points, pair)) return false;
  const auto& [i, j] = pair;
  const StepStore& step = context.step;
  const bool seen = !areExact(context, i, j) || isAmong(solved.without, pair) || awaitsRebound(context, i, j);
  const double most = seen ? mostLeft(context, i, j) : kMissed * smallerLength(context.scene.bodies, i, j);
  return overlapAt(context, i, j, step.t1) > most || havePassed(context, i, j);
}

// How far a turn in the step has moved the surface of a body at most, m: that between the quaternions p and q is at most
// pi |p - q|.
double mostTurned(const Pose& before, const Pose& now, const Traits& traits) {
  const double turn = kPi * (now.q_WB.coeffs() - before.q_WB.coeffs()).norm();
  return turn > 0.0 ? turn * traits.bounding_radius : 0.0;  // that of a plane is infinite
}

// Whether contacts may have pushed a body where no prediction has looked: off the bounds of its motion, or off a
// trajectory that an impact has changed. Most bodies hardly move.
bool mayDeviate(const Context& context, Index i) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  if (step.solver.exact || step.stamp[i] > 0) return true;
  const Traits& traits = bodies.traits[i];
  const Pose &before = step.before[i], &now = bodies.pose[i];
  if ((now.p_WB - before.p_WB).norm() + mostTurned(before, now, traits) <= kDeviation * traits.length)
    return false;
  return !step.bounds[i].holds(sweptBounds(bodies, {}, i, 0.0), kDeviation * traits.length);
}

// How far two bodies have come together in the step at most, m.
double mostMovedTogether(const Context& context, Index i, Index j) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  Vec3 moved_W = Vec3::Zero();
  double turned = 0.0;
  for (const Index k : {i, j}) {
    const Pose &before = step.before[k], now = step.poseAt(bodies, k, step.t1);
    moved_W += (k == i ? -1.0 : 1.0) * (now.p_WB - before.p_WB);
    turned += mostTurned(before, now, bodies.traits[k]);
  }
  return moved_W.norm() + turned;
}

// Pairs that rested apart when the step began (contact_states.h), and that may have come together by more than is left to the
// next step.
IndexPairs stirred(const Context& context) {
  const StepStore& step = context.step;
  IndexPairs found;
  if (step.solver.exact) return found;
  for (const Contact& contact : context.scene.contacts.active) {
    const Index i = contact.i, j = contact.j;
    if (contact.state.isSeparated() && (step.supported[i] || step.supported[j]) &&
        mostMovedTogether(context, i, j) > mostLeft(context, i, j))
      found.emplace_back(i, j);
  }
  return found;
}

}  // namespace

bool overlapDeeply(const Context& context, Index i, Index j, double time) {
  return overlapAt(context, i, j, time) > mostLeft(context, i, j);
}

IndexPairs findMissedContacts(const Context& context) {
  const SceneStore& scene = context.scene;
  const StepStore& step = context.step;
  std::vector<std::pair<Index, Bounds>> pushed;
  for (const Island& island : step.islands) {
    if (island.flies()) continue;
    for (const Index i : island.bodies)
      if (mayDeviate(context, i))
        pushed.emplace_back(i, step.bounds[i].with(sweptBounds(scene.bodies, {}, i, 0.0)));
  }
  const IndexPairs near = stirred(context);
  if (pushed.empty() && near.empty()) return {};
  std::vector<Index> order = scene.pair_search.order;
  sortByPlace(order, step.bounds);
  BoundsTree tree(order, step.bounds);
  for (const auto& [i, bounds] : pushed) tree.move(i, bounds);

  const SolvedPairs solved(scene.contacts);
  IndexPairs found;
  const auto look = [&](Index a, Index b) {
    const std::pair<Index, Index> pair = std::minmax(a, b);
    if (mayCollide(scene.bodies.traits[a], scene.bodies.traits[b]) && isMissed(context, solved, pair))
      found.push_back(pair);
  };
  for (const auto& [i, j] : near) look(i, j);
  for (const auto& [i, bounds] : pushed) {
    for (const Index j : tree.of(i)) look(i, j);
    for (const Index j : scene.lists.planes) look(i, j);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace rbs

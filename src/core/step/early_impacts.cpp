// SPDX-License-Identifier: BSD-3-Clause
#include "step/early_impacts.h"

#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"
#include "step/impacts.h"
#include "step/island_step.h"
#include "step/paths.h"

#include <algorithm>
#include <utility>

namespace rbs {

namespace {

// An impact may be taken where two bodies are in each other by this share of the smaller length.
constexpr double kLate = 5e-5;
// Two that touch at the start, as after an impact, count as apart by this share: so contacts that push them together again
// take some time for it.
constexpr double kAgain = 5e-7;
// |w| t up to which the turn between two poses is the shorter one, rad, though contacts may have doubled the spin.
constexpr double kLongestTurn = 1.5;

// An island as it is now, to be put back.
class IslandBefore {
 public:
  IslandBefore(const Context& context, Index place) : place_(place), island_(context.step.islands[place]) {
    for (const Index i : island_.bodies) {
      poses_.push_back(context.scene.bodies.pose[i]);
      twists_.push_back(context.scene.bodies.twist[i]);
    }
    for (const Index k : island_.contacts) {
      const Contact& contact = context.scene.contacts.active[k];
      contacts_.push_back(contact);
      for (const Index i : {contact.i, contact.j}) touched_.emplace_back(i, context.step.touched[i]);
    }
  }
  // All but the work that its solves have cost, and whether that was too much for the exact step.
  void putBack(Context& context) const {
    Island& island = context.step.islands[place_];
    const Island advanced = std::move(island);
    island = island_;
    island.work_left = advanced.work_left, island.exact = advanced.exact,
    island.cut_short = advanced.cut_short;
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      context.scene.bodies.pose[island.bodies[k]] = poses_[k];
      context.scene.bodies.twist[island.bodies[k]] = twists_[k];
    }
    auto contact = contacts_.begin();
    for (const Index k : island.contacts) context.scene.contacts.active[k] = *contact++;
    for (const auto& [i, touched] : touched_) context.step.touched[i] = touched;
  }

 private:
  Index place_;
  Island island_;
  std::vector<Pose> poses_;
  std::vector<Twist> twists_;
  std::vector<Contact> contacts_;
  std::vector<std::pair<Index, char>> touched_;  // of the bodies of these contacts
};

// The trajectories of the bodies of islands before these are advanced; others stay on theirs.
class Trajectories {
 public:
  Trajectories(const Context& context, const std::vector<Index>& islands) : context_(context) {
    for (const Index place : islands)
      for (const Index i : context.step.islands[place].bodies)
        of_.emplace_back(i, impacts::trajectoryOf(context, i));
    std::sort(of_.begin(), of_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  Motion of(Index i) const {
    const auto known = std::lower_bound(of_.begin(), of_.end(), i,
                                        [](const auto& trajectory, Index k) { return trajectory.first < k; });
    return known != of_.end() && known->first == i ? known->second : impacts::trajectoryOf(context_, i);
  }

 private:
  const Context& context_;
  std::vector<std::pair<Index, Motion>> of_;
};

// The pairs to look at, with a body of the islands each.
IndexPairs pairsOf(const Context& context, const std::vector<Index>& islands,
                   const std::function<std::vector<Index>(Index)>& others) {
  IndexPairs pairs;
  for (const Index place : islands)
    for (const Index i : context.step.islands[place].bodies)
      for (const Index j : others(i)) pairs.push_back(std::minmax(i, j));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

// Whether a body may have turned the longer way round in some seconds.
bool turnsFar(const Traits& traits, const Motion& trajectory, double seconds) {
  return !traits.round && !traits.unbounded && trajectory.twist.w_WB.norm() * seconds > kLongestTurn;
}

// How far apart two poses of a body have its points at most, m, beside the way of its centre.
double turned(const Traits& traits, const Pose& from, const Pose& to) {
  if (traits.round || traits.unbounded) return 0.0;
  return traits.bounding_radius * from.q_WB.angularDistance(to.q_WB);
}

// How far a body is from where its trajectory has it, m.
double deviation(const Traits& traits, const Motion& trajectory, double time, const Pose& now) {
  const Pose expected = trajectory.at(time);
  return (now.p_WB - expected.p_WB).norm() + turned(traits, expected, now);
}

// The way of a body from one pose to another, with the acceleration of its trajectory and a constant spin.
Motion pathBetween(const Motion& trajectory, double t0, const Pose& from, double t1, const Pose& to) {
  Motion way = Motion::between(t0, from, t1, to);
  way.a_W = trajectory.a_W;
  way.twist.v_WB -= 0.5 * (t1 - t0) * trajectory.a_W;
  return way;
}

// When two bodies came together on their way to where they are now, at `time`, if they did.
std::optional<double> timeOfEarlyImpact(const Context& context, const Trajectories& trajectories, Index i,
                                        Index j, double time) {
  const Traits &a = context.scene.bodies.traits[i], &b = context.scene.bodies.traits[j];
  const double length = smallerLength(context.scene.bodies, i, j);
  const Pose X_i1 = impacts::trajectoryOf(context, i).at(time),
             X_j1 = impacts::trajectoryOf(context, j).at(time);
  const double s_1 = gap(a.shape, X_i1, b.shape, X_j1).distance;
  const Motion trajectory_i = trajectories.of(i), trajectory_j = trajectories.of(j);
  const double start = std::max(trajectory_i.t0, trajectory_j.t0);
  const Pose X_i0 = trajectory_i.at(start), X_j0 = trajectory_j.at(start);
  if (s_1 >= -kLate * length) {
    // What has not left its trajectory met nothing early: that is what the prediction says, and a way is less exact.
    if (deviation(a, trajectory_i, time, X_i1) + deviation(b, trajectory_j, time, X_j1) <= kLate * length)
      return {};
    const double seconds = time - start;
    if (!(seconds > 0.0) || turnsFar(a, trajectory_i, seconds) || turnsFar(b, trajectory_j, seconds))
      return {};
    const double travel = (X_i1.p_WB - X_i0.p_WB - X_j1.p_WB + X_j0.p_WB).norm() + turned(a, X_i0, X_i1) +
                          turned(b, X_j0, X_j1);
    if (s_1 > travel) return {};
    const auto met = impactOnPaths(a.shape, pathBetween(trajectory_i, start, X_i0, time, X_i1), b.shape,
                                   pathBetween(trajectory_j, start, X_j0, time, X_j1), start, time);
    return met && met->time > start && met->beyond > kLate * length ? std::optional(met->time) : std::nullopt;
  }
  const double s_0 = gap(a.shape, X_i0, b.shape, X_j0).distance;
  if (s_0 < -kLate * length) return {};
  const double apart = std::max(s_0, kAgain * length);
  const double then = start + (time - start) * apart / (std::max(s_0, 0.0) - s_1);
  return then > start ? std::optional(then) : std::nullopt;
}

}  // namespace

bool isWatched(const StepStore& step, const Island& island, double time) {
  if (!step.solver.exact || !island.exact || island.bodies.empty() || island.time >= time) return false;
  const auto mayDeviate = [&](Index i) { return step.supported[i] || !step.load[i].torque_W.isZero(0.0); };
  return !island.flies() || !step.load_without_drag.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), mayDeviate);
}

bool mayMeetUnforeseen(const Context& context) {
  const StepStore& step = context.step;
  const auto isWatchedToEnd = [&](const Island& island) { return isWatched(step, island, step.t1); };
  return context.scene.effects[Effect::Restitution] &&
         std::any_of(step.islands.begin(), step.islands.end(), isWatchedToEnd);
}

std::optional<PendingImpact> advanceUnlessEarly(Context& context, const std::vector<Index>& islands,
                                                double time,
                                                const std::function<std::vector<Index>(Index)>& others) {
  const StepStore& step = context.step;
  std::vector<IslandBefore> before;
  for (const Index place : islands) before.emplace_back(context, place);
  const Trajectories trajectories(context, islands);
  for (const Index place : islands) advanceTo(context, context.step.islands[place], time);
  std::optional<PendingImpact> first;
  for (const auto& [i, j] : pairsOf(context, islands, others)) {
    const std::optional<double> then = timeOfEarlyImpact(context, trajectories, i, j, time);
    if (then && (!first || *then < first->time))
      first =
          PendingImpact{*then, i, j, step.stamp[i], step.stamp[j], context.scene.restitutionOf(i, j) > 0.0};
  }
  if (first)
    for (const IslandBefore& island : before) island.putBack(context);
  return first;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "step/early_meetings.h"

#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"
#include "step/impacts.h"
#include "step/island_step.h"
#include "step/ways.h"

#include <algorithm>
#include <utility>

namespace rbs {

namespace {

// Shares of the smaller length by which two may be in each other when their impact is taken; and are when it is looked at
// of two that touched at the start, as after an impact: what pushes them together again acts from there on.
constexpr double kLate = 5e-5, kAgain = 5e-7;
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
    for (const Edge& edge : island_.edges)
      if (edge.kind == ConstraintKind::Contact) contacts_.push_back(context.scene.contacts.active[edge.of]);
  }
  // All but the work that its solves have cost.
  void putBack(Context& context) const {
    Island& island = context.step.islands[place_];
    const std::int64_t work = island.work;
    island = island_;
    island.work = work;
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      context.scene.bodies.pose[island.bodies[k]] = poses_[k];
      context.scene.bodies.twist[island.bodies[k]] = twists_[k];
    }
    auto contact = contacts_.begin();
    for (const Edge& edge : island.edges)
      if (edge.kind == ConstraintKind::Contact) context.scene.contacts.active[edge.of] = *contact++;
  }

 private:
  Index place_;
  Island island_;
  std::vector<Pose> poses_;
  std::vector<Twist> twists_;
  std::vector<Contact> contacts_;  // of its edges
};

// The courses of the bodies of islands before these are advanced; others stay on theirs.
class Courses {
 public:
  Courses(const Context& context, const std::vector<Index>& islands) : context_(context) {
    for (const Index place : islands)
      for (const Index i : context.step.islands[place].bodies)
        of_.emplace_back(i, impacts::courseOf(context, i));
    std::sort(of_.begin(), of_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  Motion of(Index i) const {
    const auto known = std::lower_bound(of_.begin(), of_.end(), i,
                                        [](const auto& course, Index k) { return course.first < k; });
    return known != of_.end() && known->first == i ? known->second : impacts::courseOf(context_, i);
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
bool turnsFar(const Traits& traits, const Motion& course, double seconds) {
  return !traits.round && !traits.unbounded && course.twist.w_WB.norm() * seconds > kLongestTurn;
}

// How far apart two poses of a body have its points at most, m, beside the way of its centre.
double turned(const Traits& traits, const Pose& from, const Pose& to) {
  if (traits.round || traits.unbounded) return 0.0;
  return traits.bounding_radius * from.q_WB.angularDistance(to.q_WB);
}

// How far a body is from where its course has it, m.
double deviation(const Traits& traits, const Motion& course, double time, const Pose& now) {
  const Pose expected = course.at(time);
  return (now.p_WB - expected.p_WB).norm() + turned(traits, expected, now);
}

// The way of a body from one pose to another, with the acceleration of its course and a constant spin.
Motion wayAlong(const Motion& course, double t0, const Pose& from, double t1, const Pose& to) {
  Motion way = Motion::between(t0, from, t1, to);
  way.a_W = course.a_W;
  way.twist.v_WB -= 0.5 * (t1 - t0) * course.a_W;
  return way;
}

// When two bodies came together on their way to where they are now, at `time`, if they did.
std::optional<double> timeOfMeeting(const Context& context, const Courses& courses, Index i, Index j,
                                    double time) {
  const Traits &a = context.scene.bodies.traits[i], &b = context.scene.bodies.traits[j];
  const double length = smallerLength(context.scene.bodies, i, j);
  const Pose X_i1 = impacts::courseOf(context, i).at(time), X_j1 = impacts::courseOf(context, j).at(time);
  const double late = gap(a.shape, X_i1, b.shape, X_j1).distance;
  const Motion course_i = courses.of(i), course_j = courses.of(j);
  const double start = std::max(course_i.t0, course_j.t0);
  const Pose X_i0 = course_i.at(start), X_j0 = course_j.at(start);
  if (late >= -kLate * length) {
    // What has not left its course met nothing early: that is what the prediction says, and a way is less exact.
    if (deviation(a, course_i, time, X_i1) + deviation(b, course_j, time, X_j1) <= kLate * length) return {};
    const double seconds = time - start;
    if (!(seconds > 0.0) || turnsFar(a, course_i, seconds) || turnsFar(b, course_j, seconds)) return {};
    const double way = (X_i1.p_WB - X_i0.p_WB - X_j1.p_WB + X_j0.p_WB).norm() + turned(a, X_i0, X_i1) +
                       turned(b, X_j0, X_j1);
    if (late > way) return {};
    const auto met = metOnWay(a.shape, wayAlong(course_i, start, X_i0, time, X_i1), b.shape,
                              wayAlong(course_j, start, X_j0, time, X_j1), start, time);
    return met && met->time > start && met->beyond > kLate * length ? std::optional(met->time) : std::nullopt;
  }
  const double early = gap(a.shape, X_i0, b.shape, X_j0).distance;
  if (early < -kLate * length) return {};
  const double way = std::max(early, kAgain * length);
  const double then = start + (time - start) * way / (std::max(early, 0.0) - late);
  return then > start ? std::optional(then) : std::nullopt;
}

}  // namespace

std::optional<PendingImpact> advanceUnlessEarly(Context& context, const std::vector<Index>& islands,
                                                double time,
                                                const std::function<std::vector<Index>(Index)>& others) {
  const StepStore& step = context.step;
  std::vector<IslandBefore> before;
  for (const Index place : islands) before.emplace_back(context, place);
  const Courses courses(context, islands);
  for (const Index place : islands) advanceTo(context, context.step.islands[place], time);
  std::optional<PendingImpact> first;
  for (const auto& [i, j] : pairsOf(context, islands, others)) {
    const std::optional<double> then = timeOfMeeting(context, courses, i, j, time);
    if (then && (!first || *then < first->time))
      first = PendingImpact{*then, i, j, step.stamp[i], step.stamp[j]};
  }
  if (first)
    for (const IslandBefore& island : before) island.putBack(context);
  return first;
}

}  // namespace rbs

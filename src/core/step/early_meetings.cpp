// SPDX-License-Identifier: BSD-3-Clause
#include "step/early_meetings.h"

#include "solver/contact_preparation.h"
#include "step/impacts.h"
#include "step/island_step.h"

#include <algorithm>
#include <utility>

namespace rbs {

namespace {

// Shares of the smaller length by which two may be in each other when their impact is taken; and are when it is looked at
// of two that touched at the start, as after an impact: what pushes them together again acts from there on.
constexpr double kLate = 5e-5, kAgain = 5e-7;

struct Pair {
  Index i, j;
  double separation;
};

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

std::vector<IslandBefore> copiesOf(const Context& context, const std::vector<Index>& islands) {
  std::vector<IslandBefore> copies;
  for (const Index place : islands) copies.emplace_back(context, place);
  return copies;
}

void putBack(Context& context, const std::vector<IslandBefore>& copies) {
  for (const IslandBefore& copy : copies) copy.putBack(context);
}

// The pairs of the islands that overlap now.
std::vector<Pair> overlapsOf(const Context& context, const std::vector<Index>& islands, double time,
                             const std::function<std::vector<Index>(Index)>& others) {
  IndexPairs pairs;
  for (const Index place : islands)
    for (const Index i : context.step.islands[place].bodies)
      for (const Index j : others(i)) pairs.push_back(std::minmax(i, j));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<Pair> found;
  for (const auto& [i, j] : pairs) {
    const double separation = impacts::separationAt(context, i, j, time);
    if (separation < -kLate * smallerLength(context.scene.bodies, i, j)) found.push_back({i, j, separation});
  }
  return found;
}

}  // namespace

std::optional<PendingImpact> advanceUnlessEarly(Context& context, const std::vector<Index>& islands,
                                                double time,
                                                const std::function<std::vector<Index>(Index)>& others) {
  const StepStore& step = context.step;
  const std::vector<IslandBefore> before = copiesOf(context, islands);
  for (const Index place : islands) advanceTo(context, context.step.islands[place], time);
  const std::vector<Pair> overlaps = overlapsOf(context, islands, time, others);
  if (overlaps.empty()) return {};
  const std::vector<IslandBefore> after = copiesOf(context, islands);
  putBack(context, before);
  std::optional<PendingImpact> first;
  for (const auto& [i, j, late] : overlaps) {
    const double start = std::max(step.timeOf(i), step.timeOf(j));
    const double early = impacts::separationAt(context, i, j, start);
    const double length = smallerLength(context.scene.bodies, i, j);
    if (early < -kLate * length) continue;
    const double way = std::max(early, kAgain * length);
    const double then = start + (time - start) * way / (std::max(early, 0.0) - late);
    if (then > start && (!first || then < first->time))
      first = PendingImpact{then, i, j, step.stamp[i], step.stamp[j]};
  }
  if (!first) putBack(context, after);
  return first;
}

}  // namespace rbs

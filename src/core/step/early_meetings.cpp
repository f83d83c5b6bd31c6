// SPDX-License-Identifier: BSD-3-Clause
#include "step/early_meetings.h"

#include "solver/contact_preparation.h"
#include "step/impacts.h"
#include "step/island_step.h"

#include <algorithm>
#include <utility>

namespace rbs {

namespace {

// Share of the smaller length by which two may be in each other when their impact is taken.
constexpr double kLate = 5e-5;

struct Pair {
  Index i, j;
  double separation;
};

// The pairs of the island that overlap now, each once.
std::vector<Pair> overlapsOf(const Context& context, const Island& island,
                             const std::function<std::vector<Index>(Index)>& others) {
  std::vector<Pair> found;
  for (const Index i : island.bodies)
    for (const Index j : others(i)) {
      const bool inside = context.step.island[j] == context.step.island[i];
      if (inside && j < i) continue;
      const double separation = impacts::separationAt(context, i, j, island.time);
      if (separation < -kLate * smallerLength(context.scene.bodies, i, j))
        found.push_back({std::min(i, j), std::max(i, j), separation});
    }
  return found;
}

}  // namespace

IslandBefore::IslandBefore(const Context& context, const Island& island)
    : place_(static_cast<Index>(&island - context.step.islands.data())), island_(island) {
  for (const Index i : island.bodies) {
    poses_.push_back(context.scene.bodies.pose[i]);
    twists_.push_back(context.scene.bodies.twist[i]);
  }
  for (const Edge& edge : island.edges)
    if (edge.kind == ConstraintKind::Contact) contacts_.push_back(context.scene.contacts.active[edge.of]);
}

void IslandBefore::putBack(Context& context) const {
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

std::optional<PendingImpact> advanceUnlessEarly(Context& context, Island& island, double time,
                                                const std::function<std::vector<Index>(Index)>& others) {
  const IslandBefore before(context, island);
  const double start = island.time;
  advanceTo(context, island, time);
  const std::vector<Pair> overlaps = overlapsOf(context, island, others);
  if (overlaps.empty()) return {};
  before.putBack(context);
  std::optional<PendingImpact> first;
  for (const auto& [i, j, late] : overlaps) {
    const double early = impacts::separationAt(context, i, j, start);
    if (early <= 0.0) continue;
    const double then = start + (time - start) * early / (early - late);
    if (then > start && (!first || then < first->time))
      first = PendingImpact{then, i, j, context.step.stamp[i], context.step.stamp[j]};
  }
  if (!first) advanceTo(context, island, time);
  return first;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "step/island_contacts.h"

#include "step/impacts.h"
#include "step/island_step.h"
#include "step/islands.h"
#include "step/missed_contacts.h"

#include <algorithm>
#include <cassert>

namespace rbs {

IslandContacts::IslandContacts(Context& context, ImpactBudget& budget)
    : context_(context),
      step_(context.step),
      contacts_(context.scene.contacts),
      budget_(budget),
      found_(contacts_.active.size()),
      has_edge_(found_, 0) {
  for (const Island& island : step_.islands)
    for (const Index k : island.contacts) has_edge_[k] = 1;
}

Index IslandContacts::find(Index i, Index j) const {
  const auto [a, b] = std::minmax(i, j);
  return contacts_.find(a, b, found_);
}

Contact& IslandContacts::contactOf(Index i, Index j) {
  const Index known = find(i, j);
  return known != kNone ? contacts_.active[known] : contacts_.dormantOf(context_.scene.bodies, i, j);
}

Index IslandContacts::placeOf(Index i, Index j) {
  const Index known = find(i, j);
  return known != kNone ? known : contacts_.add(context_.scene.bodies, i, j);
}

void IslandContacts::connect(Index i, Index j, bool touches) {
  assert(step_.island[step_.movedOf(i, j)] != kNone);
  disturb(i, j);
  const Index contact = placeOf(i, j);
  PairState& state = contacts_.active[contact].state;
  touches ? state.touch() : state.open();
  if (touches) step_.touched[i] = step_.touched[j] = 1;
  Index a = step_.island[i], b = step_.island[j];
  if (a == kNone) std::swap(a, b);
  if (b != kNone && a != b) {
    bringTogether(a, b);
    a = islands::merge(context_, a, b);
  }
  Island& island = step_.islands[a];
  island.touching = island.touching || touches;
  has_edge_.resize(contacts_.active.size(), 0);
  if (has_edge_[contact]) return;
  has_edge_[contact] = 1;
  if ((island.time > step_.t0 || !set_back_.empty()) && overlapDeeply(context_, i, j, island.time))
    step_.overlapping.emplace_back(i, j);
  island.contacts.push_back(contact);
}

// Two islands by their places to one time. Where many bodies have met in the air and join a heap one after the other, each at
// a time of its own, the heap would be solved again for each of them. At the exact settings it is. Else the clock of what is
// ahead is set back: its bodies stay where they are and live through that time again. So they go a little further in this step
// than its length, with the loads and contacts of that time, which gains no energy.
void IslandContacts::bringTogether(Index a, Index b) {
  Island *behind = &step_.islands[a], *ahead = &step_.islands[b];
  if (behind->time > ahead->time) std::swap(behind, ahead);
  if (behind->time == ahead->time) return;
  const bool is_cheap = step_.solver.exact || behind->constraints() <= kSmallIsland;
  if (is_cheap || budget_.takeJoin(behind->bodies.front(), ahead->bodies.front(), behind->constraints())) {
    advanceTo(context_, *behind, ahead->time);
  } else {
    ahead->time = behind->time;
    set_back_.insert(set_back_.end(), ahead->bodies.begin(), ahead->bodies.end());
  }
}

void IslandContacts::separateOrConnect(Index i, Index j) {
  if (impacts::isFree(context_, i) && impacts::isFree(context_, j)) {
    contacts_.active[placeOf(i, j)].state.separate();
  } else {
    connect(i, j, false);
  }
}

void IslandContacts::disturb(Index i, Index j) {
  const std::vector<Traits>& traits = context_.scene.bodies.traits;
  for (const Index one : {i, j})
    if (traits[one].asleep) step_.disturbed.push_back(one);
}

}  // namespace rbs

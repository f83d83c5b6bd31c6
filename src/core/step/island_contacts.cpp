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
    bringTogether(i, j);
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

// The islands of two bodies to one time. Where many bodies have met in the air and join a heap one after the other, each at
// a time of its own, the heap would be solved again for each of them. So that has a budget, where a clock may be set back.
void IslandContacts::bringTogether(Index i, Index j) {
  Island *behind = &step_.islands[step_.island[i]], *ahead = &step_.islands[step_.island[j]];
  if (behind->time == ahead->time) return;
  if (behind->time > ahead->time) std::swap(behind, ahead), std::swap(i, j);
  const bool is_free = behind->constraints() <= kSmallIsland || !mayGoBack(j, i);
  if (is_free || budget_.takeJoin(i, j, behind->constraints())) {
    advanceTo(context_, *behind, ahead->time);
  } else {
    setBack(j, i);
  }
}

// Its load would act for longer than the step, but for the velocity that is taken from what flies. Of what moves against its load as
// body i sees it that would be a gain of energy, since it keeps its place.
bool IslandContacts::mayGoBack(Index j, Index i) const {
  if (!step_.solver.exact) return true;
  const std::vector<Twist>& twist = context_.scene.bodies.twist;
  return step_.islands[step_.island[j]].flies() &&
         (twist[j].v_WB - twist[i].v_WB).dot(step_.load[j].a_W) >= 0.0;
}

void IslandContacts::setBack(Index j, Index i) {
  Bodies& bodies = context_.scene.bodies;
  Island& ahead = step_.islands[step_.island[j]];
  const double time = step_.timeOf(i);
  if (ahead.flies()) {
    const Motion of_i = impacts::trajectoryOf(context_, i);
    bodies.pose[j].p_WB -= of_i.at(ahead.time).p_WB - of_i.at(time).p_WB;
    if (step_.solver.exact) bodies.twist[j].v_WB -= (ahead.time - time) * step_.load[j].a_W;
  }
  ahead.time = time;
  set_back_.insert(set_back_.end(), ahead.bodies.begin(), ahead.bodies.end());
}

void IslandContacts::separateOrConnect(Index i, Index j) {
  if (impacts::isFree(context_, i) && impacts::isFree(context_, j)) {
    contacts_.active[placeOf(i, j)].state.separate();
  } else {
    connect(i, j, false);
  }
}

bool IslandContacts::connectSeparated(const std::function<bool(Index)>& isWanted) {
  const auto isLarge = [&](Index i) {
    return step_.island[i] != kNone && step_.islands[step_.island[i]].constraints() > kSmallIsland;
  };
  bool found = false;
  for (Index k = 0; k < contacts_.active.size(); ++k) {
    const Index i = contacts_.active[k].i, j = contacts_.active[k].j;
    if (!contacts_.active[k].state.isSeparated() || !isWanted(step_.movedOf(i, j))) continue;
    const auto [behind, ahead] = step_.timeOf(i) <= step_.timeOf(j) ? std::pair(i, j) : std::pair(j, i);
    if (step_.solver.exact && isLarge(behind) && step_.timeOf(behind) < step_.timeOf(ahead)) {
      if (!mayGoBack(ahead, behind)) continue;
      setBack(ahead, behind);
    }
    connect(i, j, false);
    found = true;
  }
  return found;
}

void IslandContacts::disturb(Index i, Index j) {
  const std::vector<Traits>& traits = context_.scene.bodies.traits;
  for (const Index one : {i, j})
    if (traits[one].asleep) step_.disturbed.push_back(one);
}

}  // namespace rbs

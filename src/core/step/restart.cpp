// SPDX-License-Identifier: BSD-3-Clause
#include "step/restart.h"

#include "broadphase/bounds.h"
#include "step/islands.h"

#include <algorithm>

namespace rbs {

namespace {

// By body: whether its motion may be another with these pairs among the contacts.
std::vector<char> concernedBy(const Context& context, const IndexPairs& pairs) {
  const StepStore& step = context.step;
  const Index n = context.scene.bodies.size();
  DisjointSets sets = islands::candidateSets(context);
  const auto isMoved = [&](Index i) { return step.island[i] != kNone; };
  const auto unite = [&](Index i, Index j) {
    if (isMoved(i) && isMoved(j)) sets.unite(i, j);
  };
  for (const auto& [i, j] : pairs) unite(i, j);

  std::vector<char> is_root(n, 0), concerned(n, 0);
  for (const auto& [i, j] : pairs)
    for (const Index k : {i, j})
      if (isMoved(k)) is_root[sets.root(k)] = 1;
  for (const Index i : context.scene.lists.in_islands) concerned[i] = is_root[sets.root(i)];
  return concerned;
}

// The islands in canonical order, that of their first bodies, without those that others have taken in.
void sortIslands(StepStore& step) {
  std::vector<Island>& islands = step.islands;
  islands.erase(std::remove_if(islands.begin(), islands.end(),
                               [](const Island& island) { return island.bodies.empty(); }),
                islands.end());
  std::sort(islands.begin(), islands.end(),
            [](const Island& a, const Island& b) { return a.bodies.front() < b.bodies.front(); });
  for (Index k = 0; k < islands.size(); ++k)
    for (const Index i : islands[k].bodies) step.island[i] = k;
}

}  // namespace

Restart::Restart(Context& context) : at_start_(*context.step.restart_stores) {
  const Contacts& contacts = context.scene.contacts;
  at_start_.known.clear(), at_start_.earlier.clear();
  for (const Contact& contact : contacts.active)
    at_start_.known.push_back({contact.i, contact.j, contact.state});
  for (const std::vector<Contact>* list : {&contacts.active, &contacts.dormant})
    for (const Contact& contact : *list)
      if (!contact.earlier.empty()) at_start_.earlier.emplace_back(contact.key, contact.earlier);
  at_start_.impacts = context.step.impacts;
  at_start_.load.clear();
  if (!context.step.load_without_drag.empty()) at_start_.load = context.step.load;
}

// Where a pair stands among those known at the start, or is to stand.
std::vector<RestartStores::Known>::iterator Restart::placeOf(Index i, Index j) {
  return std::lower_bound(at_start_.known.begin(), at_start_.known.end(), std::pair(i, j),
                          [](const Known& known, const std::pair<Index, Index>& pair) {
                            return std::pair(known.i, known.j) < pair;
                          });
}

bool Restart::isKnown(std::vector<Known>::iterator place, Index i, Index j) const {
  return place != at_start_.known.end() && place->i == i && place->j == j;
}

// Contacts of bodies that begin again are as they were at the start, but for their points; all others stay as they are.
void Restart::restoreContacts(Context& context, const IndexPairs& missed, const std::vector<char>& again) {
  const Bodies& bodies = context.scene.bodies;
  Contacts& contacts = context.scene.contacts;
  std::vector<Contact>& active = contacts.active;
  const auto begins = [&](const ContactKey& key) {
    return again[bodies.indexOf(key.i)] || again[bodies.indexOf(key.j)];
  };
  const auto isAdded = [&](const Contact& contact) {
    return begins(contact.key) && !isKnown(placeOf(contact.i, contact.j), contact.i, contact.j);
  };
  active.erase(std::remove_if(active.begin(), active.end(), isAdded), active.end());
  contacts.sortActive();

  for (const auto& [i, j] : missed) {
    auto place = placeOf(i, j);
    if (!isKnown(place, i, j)) {
      place = at_start_.known.insert(place, {i, j, {}});
      contacts.add(bodies, i, j);
    }
    place->state.miss();
  }
  contacts.sortActive();

  for (std::vector<Contact>* list : {&active, &contacts.dormant})
    for (Contact& contact : *list)
      if (begins(contact.key)) contact.solved = false, contact.earlier.clear();
  for (Contact& contact : active)
    if (begins(contact.key)) {
      contact.state = placeOf(contact.i, contact.j)->state;
      // What rested apart may be pushed together, one pair after the other.
      const bool rests = context.step.supported[contact.i] || context.step.supported[contact.j];
      if (rests && !missed.empty() && contact.state.isSeparated()) contact.state.open();
    }
  for (const auto& [key, points] : at_start_.earlier) {
    if (!begins(key)) continue;
    const Index i = bodies.indexOf(key.i), j = bodies.indexOf(key.j),
                place = contacts.find(i, j, active.size());
    (place != kNone ? active[place] : contacts.dormantOf(bodies, i, j)).earlier = points;
  }
}

void Restart::giveBack(Context& context) {
  Bodies& bodies = context.scene.bodies;
  for (Contact& contact : context.scene.contacts.active) contact.takeBackSolves();
  restoreContacts(context, {}, std::vector<char>(bodies.size(), 1));
  for (Index i = 0; i < bodies.size(); ++i)
    bodies.pose[i] = context.step.before[i], bodies.twist[i] = context.step.twist_before[i];
  context.step.report.repeated += context.scene.lists.in_islands.size();
}

void Restart::beginAgain(Context& context, const IndexPairs& missed, int times) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  IndexPairs all = missed;
  all.insert(all.end(), step.reached.begin(), step.reached.end());
  step.impacted.insert(step.impacted.end(), step.reached.begin(), step.reached.end());
  step.reached.clear(), step.overlapping.clear();
  const std::vector<char> again = concernedBy(context, all);
  for (Island& island : step.islands)
    if (!island.bodies.empty() && again[island.bodies.front()]) {
      step.moving_pairs -= island.moving_pairs;
      island.bodies.clear();
    }
  sortIslands(step);
  Contacts& contacts = context.scene.contacts;
  IndexPairs kept_pairs;
  for (const Island& island : step.islands)
    for (const Index k : island.contacts) kept_pairs.emplace_back(contacts.active[k].i, contacts.active[k].j);
  restoreContacts(context, missed, again);
  auto pair = kept_pairs.begin();
  for (Island& island : step.islands)
    for (Index& k : island.contacts)
      k = contacts.find(pair->first, pair->second, contacts.active.size()), ++pair;

  std::vector<Index> back;
  for (const Index i : context.scene.lists.in_islands)
    if (again[i]) back.push_back(i);
  for (const Index i : back) {
    bodies.pose[i] = step.before[i], bodies.twist[i] = step.twist_before[i];
    if (!at_start_.load.empty()) step.load[i] = at_start_.load[i];
    step.bounds[i] = sweptBounds(bodies, step.load[i], i, step.h());
    step.stamp[i] = 0, step.touched[i] = 0;
  }
  step.impacts.clear();
  std::copy_if(at_start_.impacts.begin(), at_start_.impacts.end(), std::back_inserter(step.impacts),
               [&](const PendingImpact& impact) { return again[impact.i] || again[impact.j]; });

  const std::size_t kept = step.islands.size();
  islands::build(context, back);
  for (std::size_t k = kept; k < step.islands.size(); ++k) step.islands[k].work_left >>= times;
  sortIslands(step);
  step.report.repeated += static_cast<std::uint32_t>(back.size());
}

}  // namespace rbs

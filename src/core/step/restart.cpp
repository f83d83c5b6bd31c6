// SPDX-License-Identifier: BSD-3-Clause
#include "step/restart.h"

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
  for (const auto& [i, j] : step.met) unite(i, j);
  for (const auto& [i, j] : pairs) unite(i, j);
  for (const Island& island : step.islands)
    for (const Index i : island.bodies) unite(island.bodies.front(), i);

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

bool isBefore(const Contact& a, const Contact& b) {
  return a.key < b.key;
}

}  // namespace

Restart::Restart(const Context& context)
    : contacts_(context.scene.contacts), bounds_(context.step.bounds), impacts_(context.step.impacts) {}

// Contacts of bodies that begin again are as they were, all others as they are now.
void Restart::restoreContacts(Context& context, const std::vector<char>& again) {
  const Bodies& bodies = context.scene.bodies;
  const auto begins = [&](const Contact& contact) {
    return again[bodies.indexOf(contact.key.i)] || again[bodies.indexOf(contact.key.j)];
  };
  for (std::vector<Contact> Contacts::*list : {&Contacts::active, &Contacts::dormant}) {
    std::vector<Contact>& now = context.scene.contacts.*list;
    now.erase(std::remove_if(now.begin(), now.end(), begins), now.end());
    std::copy_if((contacts_.*list).begin(), (contacts_.*list).end(), std::back_inserter(now), begins);
    std::sort(now.begin(), now.end(), isBefore);
  }
}

void Restart::beginAgain(Context& context, const IndexPairs& pairs, int times) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  IndexPairs all = pairs;
  all.insert(all.end(), step.reached.begin(), step.reached.end());
  step.reached.clear();
  const std::vector<char> again = concernedBy(context, all);
  for (const auto& [i, j] : pairs) contacts_.open(bodies, i, j);
  restoreContacts(context, again);

  std::vector<Index> back;
  for (const Index i : context.scene.lists.in_islands)
    if (again[i]) back.push_back(i);
  for (const Index i : back) {
    bodies.pose[i] = step.before[i], bodies.twist[i] = step.twist_before[i];
    step.bounds[i] = bounds_[i];
    step.stamp[i] = 0;
  }
  step.impacts.clear();
  std::copy_if(impacts_.begin(), impacts_.end(), std::back_inserter(step.impacts),
               [&](const PendingImpact& impact) { return again[impact.i] || again[impact.j]; });

  for (Island& island : step.islands)
    if (!island.bodies.empty() && again[island.bodies.front()]) island.bodies.clear();
  sortIslands(step);
  Contacts& contacts = context.scene.contacts;
  for (Island& island : step.islands)
    for (Edge& edge : island.edges)
      if (edge.kind == ConstraintKind::Contact)
        edge.of = contacts.find(edge.bodies[0], edge.bodies[1], contacts.active.size());
  const std::size_t kept = step.islands.size();
  islands::build(context, back);
  for (std::size_t k = kept; k < step.islands.size(); ++k) step.islands[k].work >>= times;
  sortIslands(step);
  step.report.repeated += static_cast<std::uint32_t>(back.size());
}

}  // namespace rbs

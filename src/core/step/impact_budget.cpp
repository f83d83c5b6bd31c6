// SPDX-License-Identifier: BSD-3-Clause
#include "step/impact_budget.h"

#include <algorithm>

namespace rbs {

bool InelasticCollapse::count(Index i, Index j, double time) {
  constexpr int kQuickImpacts = 6, kMostImpacts = 1000;
  Impacts& impacts = pairs_[{i, j}];
  if (time - impacts.last > interval_) impacts.quick = 0;
  impacts.last = time;
  return ++impacts.quick > kQuickImpacts || ++impacts.all > kMostImpacts;
}

// Cutting an island with contacts costs a solve of all its pairs. What an attempt at the step may spend on cuts is a few
// times what it spends anyway, so that a large pile hit from all sides stays affordable. What comes after is the contact
// solver's, which stops it and lets it rebound at the end of the step. What has met others in the air and then joins a pile
// asks for as much: the pile must come to the time of that. Each set of bodies that may meet has its own allowance: what it
// does cannot depend on others.
//
// At the exact settings that is a number. The first few of a hundred impacts in a heap are no better than the others, and each takes
// as long as the whole step would without it; and the work that is left then is too little to find the forces of the rest.
//
// Bouncing in a tight place: far more impacts than any scene of 60 Hz needs, and finite. Without loss a pair may meet as
// often as it likes (the billiard of pi: 314159 times).
//
// Where there is no closed form, an impact costs up to a hundred times as much. A query takes about 5 us, and the rest of
// its impact as long as kQueriesPerImpact, so that those of a hundred bodies end within a second. Heaps of 45 need up to
// 98,000 in a step of 1 s. An elastic body between walls that close needs this end: its speed times their distance stays the
// same, so that it meets them without number.
ImpactBudget::ImpactBudget(const Context& context, DisjointSets& sets)
    : sets_(sets),
      lossy_(2000 + 200ull * context.scene.bodies.size()),
      elastic_(2'000'000),
      queries_(100'000 + 400ull * context.scene.bodies.size()),
      left_(context.step.island.size()) {
  if (context.step.solver.exact) {
    for (Left& left : left_) left.cuts = left.joins = kExact;
    return;
  }
  for (const Contact& contact : context.scene.contacts.active) {
    Left& left = left_[sets_.root(context.step.movedOf(contact.i, contact.j))];
    left.cuts += 4, left.joins += 4;
  }
}

bool ImpactBudget::takeImpact(bool lossy) {
  std::uint64_t& left = lossy ? lossy_ : elastic_;
  if (left == 0 || queries_ == 0) return false;
  --left;
  return true;
}

void ImpactBudget::chargeQueries(std::uint64_t queries) {
  queries_ -= std::min(queries_, queries);
}

Index ImpactBudget::unite(Index i, Index j) {
  const auto [a, b] = std::minmax({sets_.root(i), sets_.root(j)});
  if (a == b) return a;
  sets_.unite(a, b);
  left_[a].cuts += left_[b].cuts, left_[a].landings += left_[b].landings, left_[a].joins += left_[b].joins;
  return a;
}

bool ImpactBudget::take(std::uint64_t Left::*of, Index i, Index j, std::uint64_t contacts) {
  std::uint64_t& left = left_[unite(i, j)].*of;
  if (contacts > left) return false;
  left -= contacts;
  return true;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// What the impacts of a step may cost, in counts, so that results repeat and every step ends.
#pragma once

#include "base/disjoint_sets.h"
#include "state/context.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace rbs {

/// Contacts of an island that is cut without a second thought.
inline constexpr std::size_t kSmallIsland = 8;

/// Inelastic collapse: a pair that loses energy in each impact and meets again and again with hardly any time in between, as
/// happens between bodies that touch others, would go on forever; so, nearly, would one that rattles to rest in a thousand
/// small impacts (S. McNamara and W. R. Young, "Inelastic collapse in two dimensions", Phys. Rev. E 50, 1994, R28). A pair
/// without loss never collapses, however often it meets.
class InelasticCollapse {
 public:
  /// `interval`: what is in quick succession, s.
  explicit InelasticCollapse(double interval) : interval_(interval) {}
  /// Counts an impact of a pair that loses energy, at `time`: whether the pair is to stay together.
  bool count(Index i, Index j, double time);
  /// Whether an impact of the pair was counted in the step.
  bool knows(Index i, Index j) const { return pairs_.count({i, j}) > 0; }

 private:
  struct Impacts {
    double last = 0.0;
    int quick = 0, all = 0;  // those in quick succession before the last, and those of the step
  };
  double interval_;
  std::map<std::pair<Index, Index>, Impacts> pairs_;
};

/// How many impacts a step may take, how many queries for the time of one, and how many contacts may be solved again
/// because an impact cuts the step of an island, or because two islands become one.
class ImpactBudget {
 public:
  /// `sets`: the bodies that may meet each other; they outlive the budget, and cuts unite some of them.
  ImpactBudget(const Context& context, DisjointSets& sets);

  /// Makes one of the sets of two bodies, as where an impact has sent one into the other, with what both have left. Returns its root.
  Index unite(Index i, Index j);
  /// Takes one impact off, of a pair that loses energy or not. False: too many have been taken.
  bool takeImpact(bool lossy);
  /// Takes off the queries of a prediction.
  void chargeQueries(std::uint64_t queries);
  /// Calls `find`, which looks for what bodies will meet after an impact. An impact that took queries costs as much time
  /// besides as kQueriesPerImpact of them.
  template <class Find>
  void chargeImpact(const Find& find) {
    const std::uint64_t before = queries_;
    find();
    if (queries_ < before) chargeQueries(kQueriesPerImpact);
  }
  /// Takes off a cut of islands that have `contacts` in all, for bodies i and j, whose sets become one. False: their set
  /// has less left, and keeps it.
  bool takeCut(Index i, Index j, std::uint64_t contacts) { return take(&Left::cuts, i, j, contacts); }
  /// Whether a set that has spent nothing could cut so many at the exact settings.
  static bool couldCutExact(std::uint64_t contacts) { return contacts <= kExact; }
  /// Takes off such a cut for an impact that contacts stop as well.
  bool takeLanding(Index i, Index j, std::uint64_t contacts) { return take(&Left::landings, i, j, contacts); }
  /// Takes off the solve of the island that is behind, which has `contacts`, where the islands of i and j become one.
  bool takeJoin(Index i, Index j, std::uint64_t contacts) { return take(&Left::joins, i, j, contacts); }

 private:
  static constexpr std::uint64_t kQueriesPerImpact = 20;
  static constexpr std::uint64_t kExact = 512;  // contacts of a set, at the exact settings
  /// Contacts that a set may still solve again.
  struct Left {
    std::uint64_t cuts = 256, landings = 256, joins = 256;
  };

  bool take(std::uint64_t Left::*of, Index i, Index j, std::uint64_t contacts);

  DisjointSets& sets_;
  std::uint64_t lossy_, elastic_, queries_;
  std::vector<Left> left_;  // by body: of its set, where it is the root
};

}  // namespace rbs

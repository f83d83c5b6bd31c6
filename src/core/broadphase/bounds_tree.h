// SPDX-License-Identifier: BSD-3-Clause
// A tree over the bounds of bodies: which bounds overlap which.
//
// The bodies stand in an order that keeps neighbours together. Eight successive bodies make a group, eight
// successive groups a group of the next level, and so on up to one group of all. So the tree needs no links: the
// children of group g are groups 8 g to 8 g + 7 of the level below. A group has the bounds of what is in it, and
// a query skips a group whose bounds it does not overlap.
//
// The order comes from halving the bodies by their centres, along the longest side of the box around these, until
// eight are left: a k-d tree (J. L. Bentley, "Multidimensional binary search trees used for associative
// searching", Comm. ACM 18, 1975). It stays good while bodies move little, and only its speed depends on it.
// Where a body overlaps few others, finding all pairs of n bodies takes a time of n log n.
#pragma once

#include "base/workers.h"
#include "state/context.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace rbs {

/// Sorts bodies so that those near each other stand near each other. Ties go by index. Cost: n log n.
void sortByPlace(std::vector<Index>& order, const std::vector<Bounds>& bounds);

class BoundsTree {
 public:
  /// Of the bodies in `order`, with their bounds by body. Cost: n.
  BoundsTree(const std::vector<Index>& order, const std::vector<Bounds>& bounds);

  /// Whether body i is in the order: one that may meet no other is not.
  bool holds(Index i) const { return place_[i] != kNone; }

  /// Gives body i, which is in the order, other bounds. Groups do not shrink. Cost: a group a level.
  void move(Index i, const Bounds& bounds);

  /// The other bodies whose bounds overlap those of i, which is in the order, by index. Cost: log n and what is near.
  std::vector<Index> of(Index i) const;

  /// Appends the pairs that may collide and whose bounds overlap, and returns how many tests of bounds that took.
  /// Their order depends on that of the bodies.
  std::uint64_t findPairs(const std::vector<Traits>& traits, Workers& workers, IndexPairs& found) const;

 private:
  using Level = std::vector<Bounds>;

  template <class Meet>
  std::uint64_t visit(const Bounds& own, std::size_t from, const Meet& meet) const;
  std::uint64_t pairsOfGroup(std::size_t group, const std::vector<Traits>& traits, IndexPairs& found) const;
  std::size_t endOf(std::size_t group) const;

  const std::vector<Index>& order_;
  std::vector<Index> place_;   // in the order, by body
  std::vector<Level> levels_;  // the bodies, groups of them, groups of groups, ...; the last has one
};

}  // namespace rbs

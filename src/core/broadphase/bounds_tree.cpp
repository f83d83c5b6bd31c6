// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/bounds_tree.h"

#include "broadphase/parts.h"

#include <algorithm>

namespace rbs {

namespace {

constexpr std::size_t kFanBits = 3, kFan = 1 << kFanBits;
constexpr std::size_t kMostLevels = 64 / kFanBits + 2;
// Groups of which a thread takes the pairs at a time.
constexpr std::size_t kGroupsOfAPart = 32;

void include(Bounds& in, const Bounds& more) {
  in.lo = in.lo.min(more.lo);
  in.hi = in.hi.max(more.hi);
}

using Place = std::vector<Index>::iterator;

// The first part is as many whole groups as a power of two can be, so that no group crosses a cut.
void sortPart(Place first, Place last, const std::vector<Bounds>& bounds) {
  const auto size = static_cast<std::size_t>(last - first);
  if (size <= kFan) return;
  const auto centreOf = [&](Index i) -> Vec3 { return (bounds[i].lo + bounds[i].hi).head<3>(); };
  Vec3 lo = centreOf(*first), hi = lo;
  for (Place k = first; k != last; ++k) {
    const Vec3 centre = centreOf(*k);
    lo = lo.cwiseMin(centre), hi = hi.cwiseMax(centre);
  }
  int axis = 0;
  (hi - lo).maxCoeff(&axis);
  std::size_t half = kFan;
  while (2 * half < size) half *= 2;
  const Place middle = first + static_cast<std::ptrdiff_t>(half);
  std::nth_element(first, middle, last, [&](Index a, Index b) {
    const double at_a = bounds[a].lo[axis] + bounds[a].hi[axis];
    const double at_b = bounds[b].lo[axis] + bounds[b].hi[axis];
    return at_a < at_b || (at_a == at_b && a < b);
  });
  sortPart(first, middle, bounds);
  sortPart(middle, last, bounds);
}

}  // namespace

void sortByPlace(std::vector<Index>& order, const std::vector<Bounds>& bounds) {
  sortPart(order.begin(), order.end(), bounds);
}

BoundsTree::BoundsTree(const std::vector<Index>& order, const std::vector<Bounds>& bounds)
    : order_(order), place_(bounds.size(), kNone), levels_(1) {
  levels_[0].reserve(order.size());
  for (const Index i : order) {
    place_[i] = static_cast<Index>(levels_[0].size());
    levels_[0].push_back(bounds[i]);
  }
  while (levels_.back().size() > 1) {
    const Level& below = levels_.back();
    Level groups;
    groups.reserve(below.size() / kFan + 1);
    for (std::size_t k = 0; k < below.size(); ++k)
      k % kFan == 0 ? groups.push_back(below[k]) : include(groups.back(), below[k]);
    levels_.push_back(std::move(groups));
  }
}

void BoundsTree::move(Index i, const Bounds& bounds) {
  std::size_t at = place_[i];
  levels_[0][at] = bounds;
  for (std::size_t level = 1; level < levels_.size(); ++level) include(levels_[level][at /= kFan], bounds);
}

// Calls meet(group) for each group of bodies from number `from` on whose bounds overlap, and returns the number
// of tests. Groups that are left wait on a stack, the next one on top, at most kFan of a level.
template <class Meet>
std::uint64_t BoundsTree::visit(const Bounds& own, std::size_t from, const Meet& meet) const {
  if (levels_.size() < 2 || from >= levels_[1].size()) return 0;
  struct Node {
    std::size_t level, group;
  };
  Node stack[kMostLevels * kFan];
  std::size_t waiting = 0, tests = 0;
  stack[waiting++] = {levels_.size() - 1, 0};
  while (waiting > 0) {
    const auto [level, group] = stack[--waiting];
    ++tests;
    if (!own.overlaps(levels_[level][group])) continue;
    if (level == 1) {
      meet(group);
      continue;
    }
    const std::size_t begin = std::max(group * kFan, from >> kFanBits * (level - 2));
    const std::size_t end = std::min((group + 1) * kFan, levels_[level - 1].size());
    for (std::size_t child = end; child > begin; --child) stack[waiting++] = {level - 1, child - 1};
  }
  return tests;
}

std::size_t BoundsTree::endOf(std::size_t group) const {
  return std::min((group + 1) * kFan, order_.size());
}

std::vector<Index> BoundsTree::of(Index i) const {
  const Bounds& own = levels_[0][place_[i]];
  std::vector<Index> near;
  visit(own, 0, [&](std::size_t group) {
    for (std::size_t k = group * kFan; k < endOf(group); ++k)
      if (order_[k] != i && own.overlaps(levels_[0][k])) near.push_back(order_[k]);
  });
  std::sort(near.begin(), near.end());
  return near;
}

std::uint64_t BoundsTree::pairsOfGroup(std::size_t group, const std::vector<Traits>& traits,
                                       IndexPairs& found) const {
  const Level& bodies = levels_[0];
  std::uint64_t tests = 0;
  const auto test = [&](std::size_t a, std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (bodies[a].overlaps(bodies[b]) && mayCollide(traits[order_[a]], traits[order_[b]]))
        found.push_back(std::minmax(order_[a], order_[b]));
    tests += end - begin;
  };
  const std::size_t begin = group * kFan, end = endOf(group);
  for (std::size_t a = begin; a < end; ++a) test(a, a + 1, end);
  tests += visit(levels_[1][group], group + 1, [&](std::size_t other) {
    tests += end - begin;
    for (std::size_t a = begin; a < end; ++a)
      if (bodies[a].overlaps(levels_[1][other])) test(a, other * kFan, endOf(other));
  });
  return tests;
}

std::uint64_t BoundsTree::findPairs(const std::vector<Traits>& traits, Workers& workers,
                                    IndexPairs& found) const {
  if (levels_.size() < 2) return 0;
  return findInParts(workers, levels_[1].size(), kGroupsOfAPart, found,
                     [&](std::size_t group, IndexPairs& part) { return pairsOfGroup(group, traits, part); });
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/sweep_and_prune.h"

#include "broadphase/parts.h"

#include <algorithm>

namespace rbs {

namespace {

// Bodies of which a thread takes the tests at a time.
constexpr std::size_t kBodiesOfAPart = 256;

}  // namespace

// All pairs but those of which one interval ends before the other begins.
std::uint64_t sweepTests(int axis, const std::vector<Index>& order, const std::vector<Bounds>& bounds) {
  std::vector<double> begins, ends;
  for (const Index i : order) begins.push_back(bounds[i].lo[axis]), ends.push_back(bounds[i].hi[axis]);
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  const std::uint64_t n = order.size();
  std::uint64_t tests = n * (n - 1) / 2, ended = 0;
  for (const double begin : begins) {
    while (ended < n && ends[ended] < begin) ++ended;
    tests -= ended;
  }
  return tests;
}

// Bodies move little from step to step, so insertion sort needs about as many moves as bodies that overtook each
// other.
void sortByLowerEnd(int axis, std::vector<Index>& order, const std::vector<Bounds>& bounds) {
  const auto before = [&](Index a, Index b) {
    return bounds[a].lo[axis] < bounds[b].lo[axis] || (bounds[a].lo[axis] == bounds[b].lo[axis] && a < b);
  };
  std::size_t moves = 0;
  const std::size_t enough = 8 * order.size() + 64;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Index body = order[k];
    std::size_t at = k;
    for (; at > 0 && before(body, order[at - 1]); --at, ++moves) order[at] = order[at - 1];
    order[at] = body;
    if (moves > enough) {  // much has jumped: sort afresh
      std::sort(order.begin(), order.end(), before);
      return;
    }
  }
}

// The bounds stand in the order of the sweep, so that it runs through memory from front to back.
std::uint64_t sweepAlong(int axis, const std::vector<Index>& order, const std::vector<Bounds>& bounds,
                         const std::vector<Traits>& traits, Workers& workers, IndexPairs& found) {
  std::vector<Bounds> sorted;
  sorted.reserve(order.size());
  for (const Index i : order) sorted.push_back(bounds[i]);
  return findInParts(workers, sorted.size(), kBodiesOfAPart, found, [&](std::size_t k, IndexPairs& part) {
    const Bounds a = sorted[k];
    std::size_t m = k + 1;
    for (; m < sorted.size() && sorted[m].lo[axis] <= a.hi[axis]; ++m)
      if (a.overlaps(sorted[m]) && mayCollide(traits[order[k]], traits[order[m]]))
        part.push_back(std::minmax(order[k], order[m]));
    return m - k - 1;
  });
}

}  // namespace rbs

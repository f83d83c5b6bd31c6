// SPDX-License-Identifier: BSD-3-Clause
// Sweep and prune: the pairs of bodies whose bounds overlap, among those whose intervals along one axis do.
#pragma once

#include "base/workers.h"
#include "state/context.h"

#include <cstdint>
#include <vector>

namespace rbs {

/// How many tests of bounds a sweep along an axis of Bounds takes: one for each pair of intervals that overlap.
/// Cost: sorting the ends of n intervals.
std::uint64_t sweepTests(int axis, const std::vector<Index>& order, const std::vector<Bounds>& bounds);

/// Sorts bodies by the lower ends of their intervals along an axis. Ties go by index. Cost: n where they were
/// nearly sorted, else n log n.
void sortByLowerEnd(int axis, std::vector<Index>& order, const std::vector<Bounds>& bounds);

/// Appends the pairs that may collide and whose bounds overlap, of bodies that sortByLowerEnd() has sorted, and
/// returns how many tests of bounds that took.
std::uint64_t sweepAlong(int axis, const std::vector<Index>& order, const std::vector<Bounds>& bounds,
                         const std::vector<Traits>& traits, Workers& workers, IndexPairs& found);

}  // namespace rbs

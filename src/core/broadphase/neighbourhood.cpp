// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/neighbourhood.h"

#include <algorithm>

namespace rbs {

namespace {

constexpr std::size_t kGroup = 16;

void add(Bounds& to, const Bounds& more) {
  to.lo = to.lo.min(more.lo);
  to.hi = to.hi.max(more.hi);
}

}  // namespace

Neighbourhood::Neighbourhood(const std::vector<Index>& order, std::vector<Bounds>& bounds)
    : order_(order), bounds_(bounds), group_(bounds.size(), kNone) {
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Bounds& own = bounds[order[k]];
    if (k % kGroup == 0)
      around_.push_back(own);
    else
      add(around_.back(), own);
    group_[order[k]] = static_cast<Index>(k / kGroup);
  }
}

void Neighbourhood::move(Index i, const Bounds& bounds) {
  bounds_[i] = bounds;
  add(around_[group_[i]], bounds);
}

std::vector<Index> Neighbourhood::of(Index i) const {
  const Bounds& own = bounds_[i];
  std::vector<Index> near;
  for (std::size_t g = 0; g < around_.size(); ++g) {
    if (!own.overlaps(around_[g])) continue;
    const std::size_t end = std::min((g + 1) * kGroup, order_.size());
    for (std::size_t k = g * kGroup; k < end; ++k)
      if (order_[k] != i && own.overlaps(bounds_[order_[k]])) near.push_back(order_[k]);
  }
  std::sort(near.begin(), near.end());
  return near;
}

}  // namespace rbs

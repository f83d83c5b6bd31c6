// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/index.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace rbs {

/// Union-find. The root of a set is its smallest member, so that sets come in canonical order.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(Index a, Index b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "nearest.h"

#include <algorithm>

namespace rbs {
namespace {

/// How many characters must be added, removed, replaced, or exchanged with their neighbour to turn `a` into
/// `b` (optimal string alignment). `d[i][j]` is that of the first i characters of `a` and the first j of `b`.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const bool equal = a[i - 1] == b[j - 1];
      d[i][j] = std::min({d[i - 1][j - 1] + (equal ? 0 : 1), d[i - 1][j] + 1, d[i][j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  constexpr std::size_t kLongestName = 64;
  if (name.empty() || name.size() > kLongestName) return "";
  std::string nearest;
  std::size_t least = 1 + std::max<std::size_t>(2, name.size() / 3);
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace rbs

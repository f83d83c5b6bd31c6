// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/manifold.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

// The place of the largest value; of values within a thousandth of it, the first, so that rounding does not
// choose.
template <class Value>
int largest(const Manifold& manifold, double scale, const Value& value) {
  constexpr double kTie = 1e-3;
  double most = value(manifold.points[0]);
  for (int k = 1; k < manifold.size; ++k) most = std::max(most, value(manifold.points[k]));
  for (int k = 0; k < manifold.size; ++k)
    if (value(manifold.points[k]) >= most - kTie * scale) return k;
  return 0;
}

}  // namespace

void reduceToFour(Manifold& manifold) {
  if (manifold.size <= 4) return;
  const Vec3 n = manifold.n_W;
  double squared = 0.0;
  for (int k = 1; k < manifold.size; ++k)
    squared = std::max(squared, (manifold.points[k].p_W - manifold.points[0].p_W).squaredNorm());
  const double size = std::sqrt(squared);

  std::array<int, 4> kept;
  kept[0] = largest(manifold, size, [](const ManifoldPoint& p) { return -p.separation; });
  const Vec3 a = manifold.points[kept[0]].p_W;
  kept[1] = largest(manifold, squared, [&](const ManifoldPoint& p) { return (p.p_W - a).squaredNorm(); });
  const Vec3 b = manifold.points[kept[1]].p_W;
  const auto area = [&](const ManifoldPoint& p) { return n.dot((b - a).cross(p.p_W - a)); };
  kept[2] = largest(manifold, squared, [&](const ManifoldPoint& p) { return area(p); });
  kept[3] = largest(manifold, squared, [&](const ManifoldPoint& p) { return -area(p); });
  std::sort(kept.begin(), kept.end());
  const auto end = std::unique(kept.begin(), kept.end());
  manifold.size = 0;
  for (auto k = kept.begin(); k != end; ++k) manifold.points[manifold.size++] = manifold.points[*k];
}

}  // namespace rbs

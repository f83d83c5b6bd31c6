// SPDX-License-Identifier: BSD-3-Clause
// A contact manifold: the points at which two convex shapes touch or nearly touch.
#pragma once

#include "rigid_body_sim/types.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace rbs {

/// One point of a manifold.
struct ManifoldPoint {
  Vec3 p_W;               ///< midway between the two surfaces
  double separation;      ///< gap along the normal; negative is overlap
  std::uint32_t feature;  ///< same number for the same pair of features from step to step
};

/// Points that share one normal.
struct Manifold {
  static constexpr int kPoints = 32;

  Vec3 n_W = Vec3::UnitZ();  ///< unit normal, from A to B; without points, an axis that was found to separate
  int size = 0;              ///< 0: no contact within the margin
  std::array<ManifoldPoint, kPoints> points;  ///< past `size` anything: most manifolds are of few points

  Manifold() {}  // not "= default": the points would be cleared
  Manifold(const Manifold& other) { *this = other; }
  Manifold& operator=(const Manifold& other) {
    n_W = other.n_W, size = other.size;
    std::copy_n(other.points.begin(), size, points.begin());
    return *this;
  }

  void add(const Vec3& p_W, double separation, std::uint32_t feature) {
    if (size < kPoints) points[size++] = {p_W, separation, feature};
  }
};

/// The separation of its nearest points, m; infinite without points.
inline double leastSeparation(const Manifold& manifold) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < manifold.size; ++k) least = std::min(least, manifold.points[k].separation);
  return least;
}

/// Keeps the points whose separation is at most `most`, m.
inline void keepWithin(double most, Manifold& manifold) {
  const auto end = manifold.points.begin() + manifold.size;
  const auto is_open = [&](const ManifoldPoint& point) { return point.separation > most; };
  manifold.size =
      static_cast<int>(std::remove_if(manifold.points.begin(), end, is_open) - manifold.points.begin());
}

/// Keeps the deepest point and up to three others that span the largest area with it.
void reduceToFour(Manifold& manifold);

}  // namespace rbs

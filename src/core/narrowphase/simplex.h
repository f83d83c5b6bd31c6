// SPDX-License-Identifier: BSD-3-Clause
// Simplices of up to four points of a Minkowski difference, and their point nearest to the origin.
#pragma once

#include "shapes/support.h"

#include <array>

namespace rbs {

/// A point, segment, triangle or tetrahedron; `weight` are the barycentric coordinates of its point
/// nearest to the origin once reduceToNearest() has run.
struct Simplex {
  int size = 0;
  std::array<SupportPoint, 4> points;
  std::array<double, 4> weight{};

  void add(const SupportPoint& point) { points[size++] = point; }
  bool contains(const Vec3& w) const;
  Vec3 witnessA() const;
  Vec3 witnessB() const;
};

/// Reduces `simplex` to its smallest face that holds the point nearest to the origin, and returns that
/// point. A tetrahedron that stays whole holds the origin.
Vec3 reduceToNearest(Simplex& simplex);

}  // namespace rbs

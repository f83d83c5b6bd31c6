// SPDX-License-Identifier: BSD-3-Clause
// The facet of a convex shape that faces a direction: the flat piece of its surface that can lie on another
// shape.
#pragma once

#include "shapes/support.h"

#include <array>
#include <cstdint>

namespace rbs {

/// A corner, the two ends of an edge, or a polygon, anticlockwise seen from outside.
struct Facet {
  /// A face of a hull with more corners is represented by this many, spread evenly; where it is tilted, with the two
  /// farthest along the direction.
  static constexpr int kCorners = 16;

  int size = 0;
  /// Number of the point of the shape that is farthest along the direction, where it is none of the corners.
  std::uint32_t farthest_id = 65535;
  std::array<Vec3, kCorners> corners;
  std::array<std::uint32_t, kCorners>
      ids;  ///< numbers of the corners, below 65,536; a corner has one number in all facets of the shape
  /// Of the line of a round side: radius of curvature of the core across it at its two ends, m; 0 of an edge.
  std::array<double, 2> round{};

  void add(const Vec3& corner, std::uint32_t id) { corners[size] = corner, ids[size++] = id; }
};

/// The facet of the core of a shape (support.h) whose outward normal is nearest to `d`, of those that hold a
/// point of the core farthest along d, or an edge where one is. In the shape's frame; d is a unit vector. The disc of a cylinder or
/// cone is represented by eight points of its rim, and by the farthest one where it is tilted; its round side
/// by one line.
Facet facetTowards(const Box& box, const Vec3& d);
Facet facetTowards(const Capsule& capsule, const Vec3& d);
Facet facetTowards(const Cylinder& cylinder, const Vec3& d);
Facet facetTowards(const Cone& cone, const Vec3& d);
Facet facetTowards(const ConvexHull& hull, const Vec3& d);
/// Of any other shape: its farthest point.
template <class Smooth>
Facet facetTowards(const Smooth& shape, const Vec3& d) {
  Facet facet;
  facet.add(coreOf(shape)(d), 0);
  return facet;
}

}  // namespace rbs

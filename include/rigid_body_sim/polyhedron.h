// SPDX-License-Identifier: BSD-3-Clause
// A convex polyhedron: what a convex hull is made of.
#pragma once

#include "rigid_body_sim/types.h"

#include <cstdint>
#include <vector>

namespace rbs {

/// A convex solid with plane faces, in its body's frame B: the origin is its centre of mass at uniform
/// density, the axes are its principal axes. It never changes once makeHull() has made it, so bodies and
/// readers share it.
struct Polyhedron {
  /// A plane polygon. All of the solid has normal.x <= offset.
  struct Face {
    Vec3 normal;               ///< outward unit normal in B
    double offset;             ///< distance of the plane from the origin of B, m, > 0
    std::vector<int> corners;  ///< indices of three or more vertices, anticlockwise seen from outside
  };
  std::vector<Vec3> vertices;  ///< positions in B, m; each is a corner of three or more faces
  std::vector<Face> faces;     ///< all faces; makeHull() merges coplanar ones
  /// By vertex: the vertices at the other end of its edges, ascending.
  std::vector<std::vector<int>> neighbours;

  std::uint64_t fingerprint = 0;  ///< hash of the vertices, all bits of them
  Aabb bounds;                    ///< bounding box in B, m
  double bounding_radius = 0.0;   ///< radius of the smallest ball about the origin of B that holds it, m
  double inner_radius = 0.0;      ///< radius of the largest ball about the origin of B inside it, m
  double volume = 0.0;            ///< m³
  double area = 0.0;              ///< surface area, m²
  Vec3 moments_per_mass = Vec3::Zero();  ///< principal moments of inertia over the mass, m²
};

}  // namespace rbs

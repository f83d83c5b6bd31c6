// SPDX-License-Identifier: BSD-3-Clause
// A convex polyhedron: what a convex hull is made of.
#pragma once

#include "rigid_body_sim/types.h"

#include <cstdint>
#include <vector>

namespace rbs {

/// A solid with plane faces, in its body's frame B: the origin is its centre of mass at even density, the
/// axes are its principal axes. It never changes once it is made, so that bodies and their readers share it.
struct Polyhedron {
  /// A plane polygon: all of the solid has normal.x <= offset.
  struct Face {
    Vec3 normal;               ///< unit, outward
    double offset;             ///< m, > 0
    std::vector<int> corners;  ///< three or more vertices, anticlockwise seen from outside
  };
  std::vector<Vec3> vertices;  ///< m, each a corner of three or more faces
  std::vector<Face> faces;
  std::vector<std::vector<int>> neighbours;  ///< of each vertex: those at the other end of its edges

  std::uint64_t fingerprint = 0;         ///< a hash of the vertices
  Aabb bounds;                           ///< in B, m
  double bounding_radius = 0.0;          ///< of the smallest ball about the origin of B that holds it, m
  double inner_radius = 0.0;             ///< of the largest ball about the origin of B inside it, m
  double volume = 0.0;                   ///< m³
  double area = 0.0;                     ///< of the surface, m²
  Vec3 moments_per_mass = Vec3::Zero();  ///< principal moments of inertia over the mass, m²
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Meshes of unit size, of which instances are drawn: the shapes of bodies, and what is drawn with them.
#pragma once

#include "rigid_body_sim/polyhedron.h"

#include <OgreVector3.h>

#include <cstdint>
#include <vector>

namespace rbs {

/// How the surface of a body is marked, so that one sees it turn, and edges from each other.
enum class Pattern { None, Octants, Quarters, Tiles, BoxEdges };

/// Vertices with normals, and triangles (lines: pairs) of them. An instance multiplies the vertices by its size.
struct BodyMesh {
  struct Vertex {
    Ogre::Vector3 position, normal;
    float end;  ///< of a capsule: the half ball that it belongs to, +1 or -1; else 0
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint16_t> indices;
  Pattern pattern = Pattern::None;
  bool is_lines = false;
};

/// A ball of radius 1 with `rows` rows from pole to pole and twice as many columns.
BodyMesh sphereMesh(int rows, Pattern pattern = Pattern::Octants);
/// Two half balls of radius 1 at the origin, with the wall between them: `end` says to which end each goes.
BodyMesh capsuleMesh(int rows);
/// Radius 1 and half length 1, about the z axis.
BodyMesh cylinderMesh(int columns, Pattern pattern = Pattern::Quarters);
/// Radius 1 and height 1, about the z axis; the apex at z = 3/4, the base at z = -1/4.
BodyMesh coneMesh(int columns, Pattern pattern = Pattern::Quarters);
/// The corners at +-1.
BodyMesh boxMesh(Pattern pattern = Pattern::BoxEdges);
/// The edges of that box, as lines.
BodyMesh boxEdges();
/// From the origin to x = 1, as a line.
BodyMesh lineMesh();
/// The square with the corners (+-1, +-1, 0), facing z.
BodyMesh squareMesh(Pattern pattern);
/// The faces of a polyhedron, in its own size. Beyond 65,535 vertices the rest of the faces is left out.
BodyMesh polyhedronMesh(const Polyhedron& polyhedron);

}  // namespace rbs

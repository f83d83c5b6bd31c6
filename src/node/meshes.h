// SPDX-License-Identifier: BSD-3-Clause
// Triangle meshes of the shapes, as the markers of RViz want them.
//
// RViz lights a TRIANGLE_LIST only where it has one colour, and a ball of one colour does not show that it
// turns. So spheres and planes come in two tones, each a mesh of its own, which fit together like the
// fields of a chessboard.
#pragma once

#include <geometry_msgs/Point.h>

#include <vector>

#include "rigid_body_sim/shape.h"

namespace rbs {

/// Corners in the body frame, m: three a triangle, counter-clockwise seen from outside.
using TriangleMesh = std::vector<geometry_msgs::Point>;

enum class Tone { Light, Dark };

/// Four of the eight octants of a sphere about the origin. `radius` in m.
TriangleMesh sphereMesh(double radius, Tone tone);

/// A box about the origin, `size` its full extents, m: twelve triangles.
TriangleMesh boxMesh(const Vec3& size);

/// Two of the four quarters of a capsule, cylinder or cone about the z axis.
TriangleMesh roundMesh(const Shape& shape, Tone tone);

TriangleMesh polyhedronMesh(const Polyhedron& polyhedron);

/// A mesh of few triangles, at most 64, that holds a capsule, cylinder, cone or hull and not much more; the
/// bounds of a hull of many vertices.
TriangleMesh coarseMesh(const Shape& shape);

/// An icosahedron about the origin whose faces touch a sphere from outside. `radius` of the sphere, m.
TriangleMesh icosahedronMesh(double radius);

/// Every other tile of a square about the origin in the plane z = 0. `side` in m.
TriangleMesh squareMesh(double side, Tone tone);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Readers of mesh formats: from the bytes of a file to the points of its meshes.
//
// They are our own since a convex hull needs nothing but points, a file may come from anywhere, and a reader
// must know how many points there are before it makes room for them. Each takes any bytes, needs memory in
// proportion to their number, and returns or throws BadMesh in time proportional to it.
#pragma once

#include "rigid_body_sim/types.h"

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rbs::meshes {

/// Why the bytes are refused, and what is allowed instead.
struct BadMesh : std::runtime_error {
  BadMesh(const std::string& fault, std::string required)
      : std::runtime_error(fault), allowed(std::move(required)) {}
  std::string allowed;
};

using Points = std::vector<Vec3>;

/// The bytes of another file that the mesh names, by its relative URI. Throws BadMesh.
using OpenBeside = std::function<std::string(const std::string& uri)>;

Points readObj(std::string_view bytes);  ///< Wavefront: vertices of faces, or all where there are no faces
Points readStl(std::string_view bytes);  ///< text or binary: the corners of the triangles
Points readPly(std::string_view bytes);  ///< text or binary: all vertices
Points readCollada(
    std::string_view bytes);  ///< all vertices of the geometries that the scene places, m; not turned
/// glTF 2.0, as JSON or binary (GLB): all vertices of the meshes that the scene places.
Points readGltf(std::string_view bytes, const OpenBeside& beside);

/// Adds to a number of points. Throws BadMesh beyond Limits::max_hull_points.
void countPoints(std::size_t more, std::size_t& count);

/// Throws BadMesh where the text has more of these characters than a document may have elements.
void limitElements(std::string_view text, std::string_view characters);

}  // namespace rbs::meshes

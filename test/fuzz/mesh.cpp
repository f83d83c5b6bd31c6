// SPDX-License-Identifier: BSD-3-Clause
// The readers of meshes, and the hulls of what they read.
#include "targets.h"

#include "rigid_body_sim/shape.h"
#include "shapes/meshes/formats.h"

#include <cmath>

namespace rbs::fuzz {

void mesh(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto beside = [](const std::string&) -> std::string { throw meshes::BadMesh("a buffer", "none"); };
  meshes::Points points;
  try {
    switch (data[0] % 5) {
      case 0:
        points = meshes::readObj(bytes);
        break;
      case 1:
        points = meshes::readStl(bytes);
        break;
      case 2:
        points = meshes::readPly(bytes);
        break;
      case 3:
        points = meshes::readCollada(bytes);
        break;
      default:
        points = meshes::readGltf(bytes, beside);
    }
  } catch (const meshes::BadMesh&) {
    return;
  }
  constexpr std::size_t most = 1000;  // so that an input takes milliseconds
  if (points.size() > most) return;
  try {
    const PlacedHull hull = makeHull(points, "mesh");
    const Polyhedron& solid = *hull.hull.polyhedron;
    require(solid.volume > 0.0 && std::isfinite(solid.volume), "a hull without a volume");
    require(solid.moments_per_mass.minCoeff() > 0.0 && solid.moments_per_mass.allFinite(),
            "a hull without inertia");
    const PlacedHull again = makeHull(solid.vertices, "vertices");
    require(again.hull.polyhedron->fingerprint == solid.fingerprint,
            "the vertices of a hull make another hull");
  } catch (const InvalidInput&) {
  }
}

}  // namespace rbs::fuzz

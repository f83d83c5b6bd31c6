// SPDX-License-Identifier: BSD-3-Clause
#include "body_mesh.h"

#include <cmath>
#include <functional>
#include <limits>

namespace rbs {
namespace {

using Ogre::Vector3;

std::uint16_t add(BodyMesh& mesh, const Vector3& position, const Vector3& normal, float end = 0.0f) {
  mesh.vertices.push_back({position, normal, end});
  return static_cast<std::uint16_t>(mesh.vertices.size() - 1);
}

// Anticlockwise seen from outside.
void addQuad(BodyMesh& mesh, const Vector3 (&corners)[4], const Vector3& normal) {
  const std::uint16_t first = add(mesh, corners[0], normal);
  for (int k = 1; k < 4; ++k) add(mesh, corners[k], normal);
  for (const int k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(static_cast<std::uint16_t>(first + k));
}

// A grid of rows (down) and columns (around); a row is a ring with one vertex more than it has columns. At a pole,
// a ring is a point, and the quads below or above it are triangles.
void addRings(BodyMesh& mesh, int rows, int columns,
              const std::function<void(int row, float angle)>& vertex) {
  const auto first = static_cast<int>(mesh.vertices.size());
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column)
      vertex(row, 2.0f * static_cast<float>(M_PI) * static_cast<float>(column) / static_cast<float>(columns));
  const auto addTriangle = [&](int a, int b, int c) {
    const auto isOnePoint = [&](int k, int l) {
      const BodyMesh::Vertex &one = mesh.vertices[static_cast<std::size_t>(k)],
                             &other = mesh.vertices[static_cast<std::size_t>(l)];
      return one.end == other.end && one.position.positionEquals(other.position);
    };
    if (isOnePoint(a, b) || isOnePoint(b, c) || isOnePoint(c, a)) return;
    for (const int k : {a, b, c}) mesh.indices.push_back(static_cast<std::uint16_t>(k));
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int upper = first + row * (columns + 1) + column, lower = upper + columns + 1;
      addTriangle(lower, lower + 1, upper + 1);
      addTriangle(lower, upper + 1, upper);
    }
  }
}

// A disc of radius 1 across the z axis that faces up (+1) or down (-1).
void addDisc(BodyMesh& mesh, int columns, float z, float up) {
  const std::uint16_t middle = add(mesh, {0.0f, 0.0f, z}, {0.0f, 0.0f, up});
  for (int column = 0; column <= columns; ++column) {
    const float angle =
        up * 2.0f * static_cast<float>(M_PI) * static_cast<float>(column) / static_cast<float>(columns);
    const std::uint16_t rim = add(mesh, {std::cos(angle), std::sin(angle), z}, {0.0f, 0.0f, up});
    if (column == 0) continue;
    for (const int k : {static_cast<int>(middle), rim - 1, static_cast<int>(rim)})
      mesh.indices.push_back(static_cast<std::uint16_t>(k));
  }
}

}  // namespace

BodyMesh sphereMesh(int rows, Pattern pattern) {
  BodyMesh mesh;
  mesh.pattern = pattern;
  addRings(mesh, rows, 2 * rows, [&](int row, float angle) {
    const float down = static_cast<float>(M_PI) * static_cast<float>(row) / static_cast<float>(rows);
    const Vector3 p(std::sin(down) * std::cos(angle), std::sin(down) * std::sin(angle), std::cos(down));
    add(mesh, p, p);
  });
  return mesh;
}

BodyMesh capsuleMesh(int rows) {
  BodyMesh mesh;
  mesh.pattern = Pattern::Quarters;
  addRings(mesh, rows + 1, 2 * rows, [&](int ring, float angle) {
    const bool is_upper = ring <= rows / 2;
    const int row = is_upper ? ring : ring - 1;  // the equator is there twice, with the wall between
    const float down = static_cast<float>(M_PI) * static_cast<float>(row) / static_cast<float>(rows);
    const Vector3 p(std::sin(down) * std::cos(angle), std::sin(down) * std::sin(angle), std::cos(down));
    add(mesh, p, p, is_upper ? 1.0f : -1.0f);
  });
  return mesh;
}

BodyMesh cylinderMesh(int columns, Pattern pattern) {
  BodyMesh mesh;
  mesh.pattern = pattern;
  addRings(mesh, 1, columns, [&](int row, float angle) {
    const Vector3 out(std::cos(angle), std::sin(angle), 0.0f);
    add(mesh, out + Vector3(0.0f, 0.0f, row == 0 ? 1.0f : -1.0f), out);
  });
  addDisc(mesh, columns, 1.0f, 1.0f);
  addDisc(mesh, columns, -1.0f, -1.0f);
  return mesh;
}

BodyMesh coneMesh(int columns, Pattern pattern) {
  BodyMesh mesh;
  mesh.pattern = pattern;
  addRings(mesh, 1, columns, [&](int row, float angle) {
    const Vector3 out(std::cos(angle), std::sin(angle), 0.0f);
    const Vector3 p = row == 0 ? Vector3(0.0f, 0.0f, 0.75f) : out - Vector3(0.0f, 0.0f, 0.25f);
    add(mesh, p, (out + Vector3::UNIT_Z).normalisedCopy());
  });
  addDisc(mesh, columns, -0.25f, -1.0f);
  return mesh;
}

// The face of the axis i at the side s = +1 or -1 has the normal s e_i. With j and k the axes after i, in
// order, e_i = e_j x e_k, so its corners run anticlockwise from outside along (j, s k).
BodyMesh boxMesh(Pattern pattern) {
  BodyMesh mesh;
  mesh.pattern = pattern;
  const Vector3 axes[] = {Vector3::UNIT_X, Vector3::UNIT_Y, Vector3::UNIT_Z};
  for (int i = 0; i < 3; ++i) {
    for (const float s : {1.0f, -1.0f}) {
      const Vector3 n = s * axes[i], j = axes[(i + 1) % 3], k = s * axes[(i + 2) % 3];
      addQuad(mesh, {n - j - k, n + j - k, n + j + k, n - j + k}, n);
    }
  }
  return mesh;
}

BodyMesh boxEdges() {
  BodyMesh mesh;
  mesh.is_lines = true;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return (corner >> axis) & 1 ? 1.0f : -1.0f; };
    add(mesh, {side(0), side(1), side(2)}, Vector3::UNIT_Z);
    for (int axis = 0; axis < 3; ++axis) {
      if ((corner >> axis) & 1) continue;
      mesh.indices.push_back(static_cast<std::uint16_t>(corner));
      mesh.indices.push_back(static_cast<std::uint16_t>(corner | (1 << axis)));
    }
  }
  return mesh;
}

BodyMesh lineMesh() {
  BodyMesh mesh;
  mesh.is_lines = true;
  add(mesh, Vector3::ZERO, Vector3::UNIT_Z);
  add(mesh, Vector3::UNIT_X, Vector3::UNIT_Z);
  mesh.indices = {0, 1};
  return mesh;
}

BodyMesh squareMesh(Pattern pattern) {
  BodyMesh mesh;
  mesh.pattern = pattern;
  const Vector3 x = Vector3::UNIT_X, y = Vector3::UNIT_Y;
  addQuad(mesh, {-x - y, x - y, x + y, y - x}, Vector3::UNIT_Z);
  return mesh;
}

BodyMesh polyhedronMesh(const Polyhedron& polyhedron) {
  BodyMesh mesh;
  const auto toOgre = [](const Vec3& v) {
    return Vector3(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
  };
  for (const Polyhedron::Face& face : polyhedron.faces) {
    const std::size_t first = mesh.vertices.size(), count = face.corners.size();
    if (first + count > std::numeric_limits<std::uint16_t>::max()) break;
    for (const int corner : face.corners)
      add(mesh, toOgre(polyhedron.vertices[static_cast<std::size_t>(corner)]), toOgre(face.normal));
    for (std::size_t k = 2; k < count; ++k)
      for (const std::size_t corner : {first, first + k - 1, first + k})
        mesh.indices.push_back(static_cast<std::uint16_t>(corner));
  }
  return mesh;
}

}  // namespace rbs

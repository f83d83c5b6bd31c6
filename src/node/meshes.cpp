// SPDX-License-Identifier: BSD-3-Clause
#include "meshes.h"

#include <cmath>

#include "convert.h"

namespace rbs {
namespace {

constexpr int kRows = 10;     // of a sphere, from pole to pole: even, so that one edge is the equator
constexpr int kColumns = 20;  // of a sphere, around the z axis: divisible by four, one quadrant a tone
constexpr int kTiles = 16;    // along a side of a square

void addTriangle(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  mesh.insert(mesh.end(), {toPoint(a), toPoint(b), toPoint(c)});
}

void addQuad(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  addTriangle(mesh, a, b, c);
  addTriangle(mesh, a, c, d);
}

Tone toneOf(int parity) {
  return parity % 2 == 0 ? Tone::Light : Tone::Dark;
}

// A meridian of a capsule, cylinder or cone: distance from the z axis and height, from top to bottom. A
// ball's end has `rows` edges from its pole to its equator.
using Meridian = std::vector<std::pair<double, double>>;

Meridian meridianOf(const Shape& shape, int rows) {
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const double r = cylinder->radius, l = cylinder->half_length;
    return {{0.0, l}, {r, l}, {r, -l}, {0.0, -l}};
  }
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const double r = cone->radius, h = cone->height;
    return {{0.0, 0.75 * h}, {r, -0.25 * h}, {0.0, -0.25 * h}};
  }
  const Capsule& capsule = std::get<Capsule>(shape);
  Meridian meridian;
  for (int row = 0; row <= 2 * rows + 1; ++row) {
    const bool upper = row <= rows;
    const double u = M_PI / 2.0 * (upper ? rows - row : rows + 1 - row) / rows;
    meridian.emplace_back(row == 0 || row == 2 * rows + 1 ? 0.0 : capsule.radius * std::cos(u),
                          capsule.radius * std::sin(u) + (upper ? 1.0 : -1.0) * capsule.half_length);
  }
  return meridian;
}

// The surface that a meridian sweeps about the z axis, in the required sectors.
template <class Wanted>
TriangleMesh revolve(const Meridian& meridian, int columns, Wanted wanted) {
  const auto sample = [&](std::size_t row, int column) -> Vec3 {
    const double v = 2.0 * M_PI * column / columns;
    const auto [r, z] = meridian[row];
    return {r * std::cos(v), r * std::sin(v), z};
  };
  TriangleMesh mesh;
  for (int column = 0; column < columns; ++column) {
    if (!wanted(column)) continue;
    for (std::size_t row = 0; row + 1 < meridian.size(); ++row) {
      const Vec3 a = sample(row + 1, column), b = sample(row + 1, column + 1);
      const Vec3 c = sample(row, column + 1), d = sample(row, column);
      if (meridian[row + 1].first > 0.0) addTriangle(mesh, a, b, c);
      if (meridian[row].first > 0.0) addTriangle(mesh, a, c, d);
    }
  }
  return mesh;
}

}  // namespace

TriangleMesh roundMesh(const Shape& shape, Tone tone) {
  constexpr int kSectors = 40;  // divisible by four, one quarter a tone
  return revolve(meridianOf(shape, kRows / 2), kSectors,
                 [&](int column) { return toneOf(column / (kSectors / 4)) == tone; });
}

TriangleMesh polyhedronMesh(const Polyhedron& polyhedron) {
  TriangleMesh mesh;
  for (const Polyhedron::Face& face : polyhedron.faces) {
    for (std::size_t k = 2; k < face.corners.size(); ++k) {
      addTriangle(mesh, polyhedron.vertices[face.corners[0]], polyhedron.vertices[face.corners[k - 1]],
                  polyhedron.vertices[face.corners[k]]);
    }
  }
  return mesh;
}

// A regular polygon of n sides holds a circle when its corners are 1/cos(pi/n) times as far from the middle.
// A capsule's meridian is half of such a polygon.
TriangleMesh coarseMesh(const Shape& shape) {
  constexpr int kSectors = 8, kMostVertices = 32;
  const double outward = 1.0 / std::cos(M_PI / kSectors);
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    if (hull->polyhedron->vertices.size() <= kMostVertices) return polyhedronMesh(*hull->polyhedron);
    const Aabb& bounds = hull->polyhedron->bounds;
    TriangleMesh box = boxMesh(bounds.hi - bounds.lo);
    for (geometry_msgs::Point& p : box) p = toPoint(fromMsg(p) + 0.5 * (bounds.lo + bounds.hi));
    return box;
  }
  Shape outer = shape;
  if (auto* capsule = std::get_if<Capsule>(&outer)) capsule->radius *= outward;
  Meridian meridian = meridianOf(outer, kSectors / 4);
  for (auto& [r, z] : meridian) r *= outward;
  return revolve(meridian, kSectors, [](int) { return true; });
}

// A point of the sphere of radius r has latitude u in [-pi/2, pi/2] and longitude v in [0, 2 pi]:
//   x = r cos u cos v,   y = r cos u sin v,   z = r sin u.
// A field between two samples of u and two of v is a quad, and a triangle where it touches a pole.
TriangleMesh sphereMesh(double radius, Tone tone) {
  const auto sample = [radius](int row, int column) -> Vec3 {
    const double u = M_PI * row / kRows - M_PI / 2.0;
    const double v = 2.0 * M_PI * column / kColumns;
    return radius * Vec3(std::cos(u) * std::cos(v), std::cos(u) * std::sin(v), std::sin(u));
  };
  TriangleMesh mesh;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int hemisphere = row / (kRows / 2);
      const int quadrant = column / (kColumns / 4);
      if (toneOf(hemisphere + quadrant) != tone) continue;
      const Vec3 a = sample(row, column), b = sample(row, column + 1);
      const Vec3 c = sample(row + 1, column + 1), d = sample(row + 1, column);
      if (row > 0) addTriangle(mesh, a, b, c);
      if (row < kRows - 1) addTriangle(mesh, a, c, d);
    }
  }
  return mesh;
}

// The face of the axis i at the side s = +1 or -1 has the normal s e_i. With j and k the axes after i, in
// order, e_i = e_j x e_k, so its corners run counter-clockwise from outside along (j, s k).
TriangleMesh boxMesh(const Vec3& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 3; ++i) {
    for (const double s : {1.0, -1.0}) {
      const Vec3 n = s * 0.5 * size[i] * Vec3::Unit(i);
      const Vec3 j = 0.5 * size[(i + 1) % 3] * Vec3::Unit((i + 1) % 3);
      const Vec3 k = s * 0.5 * size[(i + 2) % 3] * Vec3::Unit((i + 2) % 3);
      addQuad(mesh, n - j - k, n + j - k, n + j + k, n - j + k);
    }
  }
  return mesh;
}

// With the golden ratio g, the even permutations of (0, +-1, +-g) are the corners of an icosahedron with the
// edge 2 (Coxeter, Regular Polytopes, 3.7). Its faces are all the triples of corners with that distance from
// each other, and their distance from the origin is g^2 / sqrt(3).
TriangleMesh icosahedronMesh(double radius) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  const double scale = radius * std::sqrt(3.0) / (g * g);
  std::vector<Vec3> corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : {1.0, -1.0}) {
      for (const double t : {g, -g}) {
        corners.push_back(scale * (s * Vec3::Unit((axis + 1) % 3) + t * Vec3::Unit((axis + 2) % 3)));
      }
    }
  }
  const auto isEdge = [&](const Vec3& a, const Vec3& b) { return (a - b).norm() < 2.1 * scale; };
  TriangleMesh mesh;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const Vec3 &a = corners[i], &b = corners[j], &c = corners[k];
        if (!isEdge(a, b) || !isEdge(b, c) || !isEdge(c, a)) continue;
        const bool is_outward = (b - a).cross(c - a).dot(a) > 0.0;
        is_outward ? addTriangle(mesh, a, b, c) : addTriangle(mesh, a, c, b);
      }
    }
  }
  return mesh;
}

TriangleMesh squareMesh(double side, Tone tone) {
  const auto corner = [side](int i, int j) -> Vec3 {
    return {side * i / kTiles - 0.5 * side, side * j / kTiles - 0.5 * side, 0.0};
  };
  TriangleMesh mesh;
  for (int i = 0; i < kTiles; ++i) {
    for (int j = 0; j < kTiles; ++j) {
      if (toneOf(i + j) != tone) continue;
      addQuad(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  return mesh;
}

}  // namespace rbs

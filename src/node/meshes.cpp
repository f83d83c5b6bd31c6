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

}  // namespace

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

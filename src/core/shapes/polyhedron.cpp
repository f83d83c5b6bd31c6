// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls of points: qhull finds the triangles; here they become polygons with mass properties.
//
// A hull is made again from its own vertices until they no longer change: then it is in its body's frame, no
// vertex is superfluous, and what it was last made of is what a scene file holds of it. So a hull that is
// written and read again is the same, bit for bit.
#include "base/number_text.h"
#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/shape.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>

namespace rbs {
namespace {

// Of the extents: what counts as coplanar. Mesh files hold numbers of single precision, 6e-8.
constexpr double kFlat = 1e-6;
// Of the extents: a centre of mass, and of the moments: products of inertia, that rounding leaves.
constexpr double kCentred = 1e-13;

using Points = std::vector<Vec3>;
using Triangle = std::array<int, 3>;  // anticlockwise seen from outside
using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMat3 = Eigen::Matrix<long double, 3, 3>;

[[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{path, value, allowed}});
}

std::string pointCount(std::size_t n) {
  return std::to_string(n) + (n == 1 ? " point" : " points");
}

Aabb boundsOf(const Points& points) {
  Aabb bounds{points[0], points[0]};
  for (const Vec3& p : points) bounds = {bounds.lo.cwiseMin(p), bounds.hi.cwiseMax(p)};
  return bounds;
}

// --- what can be a hull

/// The point that is farthest from the origin of `offset`.
template <class Offset>
Vec3 farthest(const Points& points, Offset offset) {
  Vec3 most = Vec3::Zero();
  for (const Vec3& p : points) {
    if (const Vec3 d = offset(p); d.squaredNorm() > most.squaredNorm()) most = d;
  }
  return most;
}

/// Why the points have no inside; empty where they have. The first point, the one farthest from it, the one
/// farthest from their line, and the one farthest from their plane span a tetrahedron, which may be too thin.
std::string flatness(const Points& points) {
  const Vec3 a = farthest(points, [&](const Vec3& p) { return Vec3(p - points[0]); });
  const double length = a.norm();
  if (!(length > 1e-30)) return pointCount(points.size()) + " at the same place";
  const Vec3 x = a / length;
  const auto offLine = [&](const Vec3& p) -> Vec3 {
    const Vec3 d = p - points[0];
    return d - x.dot(d) * x;
  };
  const Vec3 b = farthest(points, offLine);
  const std::string least = ", but for " + numberText(kFlat) + " of the extent";
  if (b.norm() <= kFlat * length) return "points on a line" + least;
  const Vec3 normal = x.cross(b).normalized();
  const auto offPlane = [&](const Vec3& p) -> Vec3 { return normal.dot(p - points[0]) * normal; };
  if (farthest(points, offPlane).norm() <= kFlat * length) return "points in a plane" + least;
  return "";
}

void checkPoints(const Points& points, const std::string& path) {
  if (points.size() < 4) refuse(path, pointCount(points.size()), "4 points or more: a hull is a solid");
  if (points.size() > Limits::max_hull_points) {
    refuse(path, pointCount(points.size()), "at most " + pointCount(Limits::max_hull_points));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite() && points[i].cwiseAbs().maxCoeff() <= Limits::max_position) continue;
    refuse(path + "[" + std::to_string(i) + "]", vectorText(points[i]),
           "finite coordinates of at most " + numberText(Limits::max_position) + " m");
  }
  if (const std::string fault = flatness(points); !fault.empty()) refuse(path, fault, "points of a solid");
}

// --- triangles

/// Coordinates in which the bounds are the cube from -1 to 1: flatness does not depend on the proportions.
Points normalised(const Points& points) {
  const Aabb bounds = boundsOf(points);
  const Vec3 middle = 0.5 * (bounds.lo + bounds.hi), half = 0.5 * (bounds.hi - bounds.lo);
  Points result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back((p - middle).cwiseQuotient(half));
  return result;
}

/// Runs qhull and frees what it held.
class Qhull {
 public:
  Qhull(Points points, const std::string& path) : points_(std::move(points)) {
    messages_ = open_memstream(&text_, &size_);
    qh_zero(&qh_, messages_);
    static char command[] = "qhull Qt";  // triangulated; coplanar facets are merged below, by our own rule
    const int fault = qh_new_qhull(&qh_, 3, static_cast<int>(points_.size()), points_.front().data(), False,
                                   command, nullptr, messages_);
    if (fault == qh_ERRnone) return;
    std::fflush(messages_);
    const std::string reason(text_, std::find(text_, text_ + size_, '\n'));
    release();
    refuse(path, pointCount(points_.size()) + ", of which qhull says: " + reason, "points of a solid");
  }
  ~Qhull() { release(); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  std::vector<Triangle> triangles() {
    std::vector<Triangle> result;
    qhT* const qh = &qh_;
    facetT* facet;
    FORALLfacets {
      setT* corners = qh_facet3vertex(qh, facet);
      Triangle& triangle = result.emplace_back();
      for (int k = 0; k < 3; ++k) {
        triangle[k] = qh_pointid(qh, SETelemt_(corners, k, vertexT)->point);
      }
      qh_settempfree(qh, &corners);
    }
    return result;
  }

 private:
  void release() {
    qh_freeqhull(&qh_, !qh_ALL);
    int blocks, bytes;
    qh_memfreeshort(&qh_, &blocks, &bytes);
    std::fclose(messages_);
    std::free(text_);
  }

  Points points_;
  qhT qh_;
  FILE* messages_;
  char* text_ = nullptr;
  std::size_t size_ = 0;
};

Vec3 areaVector(const Points& points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

/// The triangles of the hull of points.
std::vector<Triangle> triangulate(const Points& points, const std::string& path) {
  std::vector<Triangle> triangles = Qhull(points, path).triangles();
  double volume = 0.0;
  for (const Triangle& t : triangles) volume += points[t[0]].dot(areaVector(points, t));
  if (volume < 0.0) {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
  }
  return triangles;
}

/// The points that are vertices of the hull, found in parts: those of a part, with those of the parts before
/// it, at a time. What is inside the hull of some of the points is inside that of all. So the work is bounded
/// however many points there are, and can be interrupted. Few points are left as they are.
Points reduced(const Points& points, const std::string& path) {
  constexpr std::size_t part = 8192, most = 4 * Limits::max_hull_vertices;
  if (points.size() <= 2 * part) return points;
  Points kept;
  for (std::size_t begin = 0; begin < points.size(); begin += part) {
    stopIfInterrupted(path);
    kept.insert(kept.end(), points.begin() + begin, points.begin() + std::min(begin + part, points.size()));
    if (!flatness(kept).empty()) continue;
    std::vector<char> on_hull(kept.size(), 0);
    for (const Triangle& t : triangulate(normalised(kept), path))
      for (const int v : t) on_hull[v] = 1;
    Points vertices;
    for (std::size_t v = 0; v < kept.size(); ++v)
      if (on_hull[v]) vertices.push_back(kept[v]);
    kept = std::move(vertices);
    if (kept.size() > most) {
      refuse(path, "more than " + pointCount(most) + " on the hull",
             "at most " + pointCount(Limits::max_hull_vertices) + ": leave details out");
    }
  }
  return kept;
}

// --- polygons

using Edge = std::pair<int, int>;

Edge edgeOf(const Triangle& t, int k) {
  return {t[k], t[(k + 1) % 3]};
}

/// The number of the face that each triangle is part of. A face grows from the largest triangle that is left,
/// by neighbours whose corners lie in its plane.
std::vector<int> facesOf(const Points& points, const std::vector<Triangle>& triangles) {
  const int n = static_cast<int>(triangles.size());
  std::map<Edge, int> behind;  // the triangle with this edge
  std::vector<Vec3> areas;
  std::vector<int> by_area;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) behind[edgeOf(triangles[i], k)] = i;
    areas.push_back(areaVector(points, triangles[i]));
    by_area.push_back(i);
  }
  std::stable_sort(by_area.begin(), by_area.end(),
                   [&](int i, int j) { return areas[i].squaredNorm() > areas[j].squaredNorm(); });
  std::vector<int> face_of(n, -1);
  int faces = 0;
  for (const int seed : by_area) {
    if (face_of[seed] >= 0) continue;
    const Vec3 normal = areas[seed].normalized();
    const Vec3& origin = points[triangles[seed][0]];
    // A sliver faces anywhere.
    const auto belongs = [&](int i) {
      if (face_of[i] >= 0 || normal.dot(areas[i]) < -kFlat * kFlat) return false;
      const auto inPlane = [&](int v) { return std::abs(normal.dot(points[v] - origin)) <= kFlat; };
      return std::all_of(triangles[i].begin(), triangles[i].end(), inPlane);
    };
    std::vector<int> grown{seed};
    face_of[seed] = faces;
    for (std::size_t next = 0; next < grown.size(); ++next) {
      for (int k = 0; k < 3; ++k) {
        const auto [from, to] = edgeOf(triangles[grown[next]], k);
        const auto beside = behind.find({to, from});
        if (beside == behind.end() || !belongs(beside->second)) continue;
        face_of[beside->second] = faces;
        grown.push_back(beside->second);
      }
    }
    ++faces;
  }
  return face_of;
}

/// The points at which so many faces or more meet, in the order of the points.
Points corners(const Points& points, const std::vector<Triangle>& triangles, const std::vector<int>& face_of,
               std::size_t least) {
  std::vector<std::set<int>> faces_at(points.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const int v : triangles[i]) faces_at[v].insert(face_of[i]);
  }
  Points result;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (faces_at[v].size() >= least) result.push_back(points[v]);
  }
  return result;
}

using Outline = std::vector<int>;  // the corners of a face, in order

/// Each face as the cycle of its corners: the edges of its triangles that no other of them has. Empty where
/// such edges are no one cycle.
std::vector<Outline> outlinesOf(const std::vector<Triangle>& triangles, const std::vector<int>& face_of) {
  std::map<Edge, int> face_behind;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) face_behind[edgeOf(triangles[i], k)] = face_of[i];
  }
  std::vector<std::map<int, int>> next(*std::max_element(face_of.begin(), face_of.end()) + 1);
  for (const auto& [edge, face] : face_behind) {
    const auto beside = face_behind.find({edge.second, edge.first});
    if (beside == face_behind.end() || beside->second != face) next[face][edge.first] = edge.second;
  }
  std::vector<Outline> result;
  for (const std::map<int, int>& follow : next) {
    Outline& outline = result.emplace_back();
    int v = follow.begin()->first;
    do {
      outline.push_back(v);
      const auto step = follow.find(v);
      if (step == follow.end() || outline.size() > follow.size()) return {};
      v = step->second;
    } while (v != outline.front());
    if (outline.size() != follow.size()) return {};
  }
  return result;
}

// --- mass

struct Mass {
  long double volume = 0.0L;
  LongVec3 centre = LongVec3::Zero();
  LongMat3 second = LongMat3::Zero();  // integral of x x^T about the centre, over the volume
};

// A solid is the sum of the tetrahedra from an apex o to its triangles a, b, c, those that face o negative
// (B. Mirtich, Fast and accurate computation of polyhedral mass properties, J. Graphics Tools 1, 1996). With
// a, b, c seen from o and s = a + b + c,
//   volume             V = a.(b x c) / 6
//   integral of x      V s / 4
//   integral of x x^T  V (a a^T + b b^T + c c^T + s s^T) / 20
// since the mean of l_i l_j over a simplex with barycentric coordinates l is (1 + [i = j]) / 20 (F. Tonon,
// Explicit exact formulas for the 3-D tetrahedron inertia tensor, J. Math. Stat. 1, 2005).
Mass massOf(const Points& points, const std::vector<Triangle>& triangles) {
  const Aabb bounds = boundsOf(points);
  const LongVec3 apex = (0.5 * (bounds.lo + bounds.hi)).cast<long double>();
  Mass mass;
  for (const Triangle& t : triangles) {
    LongMat3 corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = points[t[k]].cast<long double>() - apex;
    const LongVec3 sum = corners.rowwise().sum();
    const long double volume = corners.col(0).dot(corners.col(1).cross(corners.col(2))) / 6.0L;
    mass.volume += volume;
    mass.centre += volume / 4.0L * sum;
    mass.second += volume / 20.0L * (corners * corners.transpose() + sum * sum.transpose());
  }
  mass.centre /= mass.volume;
  mass.second = LongMat3(mass.second / mass.volume - mass.centre * mass.centre.transpose());
  mass.centre += apex;
  return mass;
}

/// The rotation in the plane of axes i and j that takes the product S_ij away, by at most 45 degrees
/// (Jacobi).
LongMat3 planeRotation(const LongMat3& S, int i, int j) {
  const long double angle = 0.5L * std::atan(2.0L * S(i, j) / (S(i, i) - S(j, j)));
  LongMat3 R = LongMat3::Identity();
  R(i, i) = R(j, j) = std::cos(angle);
  R(j, i) = std::sin(angle);
  R(i, j) = -R(j, i);
  return R;
}

/// Principal axes of a second moment as the columns of a rotation near the identity: the identity itself
/// where the products are no more than rounding.
Mat3 principalAxes(LongMat3 S) {
  const auto share = [&](int i, int j) { return std::abs(S(i, j)) / std::max(S(i, i), S(j, j)); };
  LongMat3 axes = LongMat3::Identity();
  bool turned = false;
  for (int sweep = 0; sweep < 60; ++sweep) {
    std::pair<int, int> worst{0, 1};
    for (const auto& pair : {std::pair{0, 2}, std::pair{1, 2}}) {
      if (share(pair.first, pair.second) > share(worst.first, worst.second)) worst = pair;
    }
    if (!(share(worst.first, worst.second) > kCentred)) break;
    const LongMat3 R = planeRotation(S, worst.first, worst.second);
    S = LongMat3(R.transpose() * S * R);
    axes = LongMat3(axes * R);
    turned = true;
  }
  if (!turned) return Mat3::Identity();
  // Of the 24 ways to name the axes and choose their signs that are rotations, the nearest to the identity
  // is the one of largest trace.
  LongMat3 nearest = axes;
  for (const auto& order : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
    for (int signs = 0; signs < 8; ++signs) {
      LongMat3 named;
      for (int k = 0; k < 3; ++k) named.col(k) = (signs >> k & 1 ? -1.0L : 1.0L) * axes.col(order[k]);
      if (named.determinant() > 0.0L && named.trace() > nearest.trace()) nearest = named;
    }
  }
  return nearest.cast<double>();
}

bool isCentred(const Vec3& centre, const Aabb& bounds) {
  const Vec3 extents = bounds.hi - bounds.lo;
  return (centre.cwiseAbs().array() <= kCentred * extents.array()).all();
}

// --- the whole

/// A number made of all bits of the points (Fowler, Noll and Vo's hash, by words).
std::uint64_t fingerprint(const Points& points) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const Vec3& p : points) {
    for (const double x : {p.x(), p.y(), p.z()}) {
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof bits);
      hash = (hash ^ bits) * 0x100000001b3ull;
    }
  }
  return hash;
}

Polyhedron assemble(const Points& points, const std::vector<Outline>& outlines, const Mass& mass) {
  Polyhedron solid;
  solid.vertices = points;
  solid.fingerprint = fingerprint(points);
  std::vector<std::set<int>> neighbours(points.size());
  for (const Outline& outline : outlines) {
    // Newell's normal: the mean of all corners' planes. Its length is twice the area.
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const int from = outline[k], to = outline[(k + 1) % outline.size()];
      normal += (points[from] - points[outline[0]]).cross(points[to] - points[outline[0]]);
      neighbours[from].insert(to);
      neighbours[to].insert(from);
    }
    solid.area += 0.5 * normal.norm();
    normal.normalize();
    double offset = normal.dot(points[outline[0]]);
    for (const Vec3& p : points) offset = std::max(offset, normal.dot(p));
    solid.faces.push_back({normal, offset, outline});
  }
  for (const std::set<int>& set : neighbours) solid.neighbours.emplace_back(set.begin(), set.end());

  solid.bounds = boundsOf(points);
  for (const Vec3& p : points) solid.bounding_radius = std::max(solid.bounding_radius, p.norm());
  solid.inner_radius = solid.bounding_radius;
  for (const Polyhedron::Face& face : solid.faces) {
    solid.inner_radius = std::min(solid.inner_radius, face.offset);
  }
  solid.volume = static_cast<double>(mass.volume);
  const Vec3 squares = mass.second.diagonal().cast<double>();
  solid.moments_per_mass = Vec3::Constant(squares.sum()) - squares;
  return solid;
}

}  // namespace

// Bits are kept where there is nothing to do: adding 0 would take the sign of a -0.
Pose PlacedHull::poseOfB(const Pose& X_WP) const {
  if (X_PB.p_WB.isZero(0.0) && X_PB.q_WB.coeffs() == Quat::Identity().coeffs()) return X_WP;
  const Quat q_WP = X_WP.q_WB.normalized();
  return {X_WP.p_WB + q_WP * X_PB.p_WB, q_WP * X_PB.q_WB};
}

PlacedHull makeHull(const std::vector<Vec3>& points, const std::string& path) {
  checkPoints(points, path);
  Pose X_PB;
  Mat3 R_PB = Mat3::Identity();
  Points now = reduced(points, path);
  constexpr int kPasses = 50;  // a dozen in the worst case known
  for (int pass = 0; pass < kPasses; ++pass) {
    stopIfInterrupted(path);
    const Points shape = normalised(now);
    const std::vector<Triangle> triangles = triangulate(shape, path);
    const std::vector<int> face_of = facesOf(shape, triangles);
    const Mass mass = massOf(now, triangles);
    const Vec3 centre = mass.centre.cast<double>();
    const Mat3 axes = principalAxes(mass.second);
    const bool stays = axes.isIdentity(0.0) && isCentred(centre, boundsOf(now));
    // Flatness is checked in B, where the bounds are tight.
    Points kept = corners(now, triangles, face_of, stays ? 3 : 1);
    if (stays && kept.size() > Limits::max_hull_vertices) {
      refuse(path, pointCount(kept.size()) + " on the hull",
             "at most " + pointCount(Limits::max_hull_vertices) + ": leave details out");
    }
    if (stays && kept.size() == now.size()) {
      const std::vector<Outline> outlines = outlinesOf(triangles, face_of);
      if (outlines.empty()) break;
      X_PB.q_WB = Quat(R_PB);
      return {{std::make_shared<Polyhedron>(assemble(now, outlines, mass))}, X_PB};
    }
    if (!stays) {
      for (Vec3& p : kept) p = axes.transpose() * (p - centre);
      X_PB.p_WB += R_PB * centre;
      R_PB = R_PB * axes;
    }
    now = std::move(kept);
  }
  refuse(path, pointCount(points.size()), "points whose hull is beyond doubt: leave out details");
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The signed gap of two convex polytopes by enumeration in long double: every vertex against every face,
// every edge against every edge; every face normal and every cross product of two edges. Slow, and obviously
// right: no feature and no axis that is looked at in vain does harm, because the nearest pair of features and
// the best axis win.
#pragma once

#include "core/narrowphase_oracles.h"

#include <array>
#include <set>

namespace rbs::oracle {

inline constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
inline constexpr Real kRealEpsilon = std::numeric_limits<Real>::epsilon();

/// A solid, a segment (two vertices, one edge) or a point (one vertex, one edge from it to itself).
struct Polytope {
  struct Face {
    Vec normal;                ///< unit, outward
    std::vector<int> corners;  ///< anticlockwise seen from outside
  };
  std::vector<Vec> vertices;
  std::vector<Face> faces;
  std::vector<std::array<int, 2>> edges;
  std::vector<Vec> directions;  ///< of the edges, unit, parallel ones once
};

inline Polytope polytopeOfPoint() {
  return {{Vec::Zero()}, {}, {{0, 0}}, {}};
}

/// Along z.
inline Polytope polytopeOfSegment(Real half_length) {
  return {{Vec(0, 0, -half_length), Vec(0, 0, half_length)}, {}, {{0, 1}}, {Vec::UnitZ()}};
}

inline void addDirection(Polytope& polytope, const Vec& along) {
  const Vec unit = along.normalized();
  for (const Vec& other : polytope.directions)
    if (unit.cross(other).norm() <= 8 * kRealEpsilon) return;
  polytope.directions.push_back(unit);
}

/// The corners of the convex polygon of points in a plane, anticlockwise about `up` (A. M. Andrew's chain).
inline std::vector<int> cornersOf(const std::vector<Vec>& points, std::vector<int> in_plane, const Vec& up) {
  const Vec x = up.unitOrthogonal(), y = up.cross(x);
  const auto before = [&](int l, int m) {
    const Vec d = points[m] - points[l];
    return d.dot(x) > 0 || (d.dot(x) == 0 && d.dot(y) > 0);
  };
  std::sort(in_plane.begin(), in_plane.end(), before);
  std::vector<int> corners;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = corners.size();
    for (const int m : in_plane) {
      while (corners.size() >= first + 2) {
        const Vec& k = points[corners[corners.size() - 2]];
        const Vec& l = points[corners.back()];
        if ((l - k).cross(points[m] - l).dot(up) > 0) break;
        corners.pop_back();
      }
      corners.push_back(m);
    }
    corners.pop_back();  // the first of the other side
    std::reverse(in_plane.begin(), in_plane.end());
  }
  return corners;
}

/// The convex hull of distinct points with volume: a plane through three points is a face where no point lies
/// beyond it. What lies in the plane is decided by the rounding of its determinant.
inline Polytope hullOf(const std::vector<Vec>& points) {
  const int n = static_cast<int>(points.size());
  Polytope hull;
  hull.vertices = points;
  std::set<std::vector<int>> known;
  std::set<std::array<int, 2>> edges;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        const Vec e = points[j] - points[i], f = points[k] - points[i];
        bool above = false, below = false;
        std::vector<int> in_plane;
        for (int m = 0; m < n; ++m) {
          const Vec g = points[m] - points[i];
          Real det = 0, size = 0;
          for (int c = 0; c < 3; ++c) {
            const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            det += g[c] * (e[c1] * f[c2] - e[c2] * f[c1]);
            size += std::abs(g[c]) * (std::abs(e[c1] * f[c2]) + std::abs(e[c2] * f[c1]));
          }
          if (std::abs(det) <= 8 * kRealEpsilon * size)
            in_plane.push_back(m);
          else
            (det > 0 ? above : below) = true;
        }
        if (above == below || !known.insert(in_plane).second) continue;
        // The normal comes from the largest triangle of the plane: the first may be as good as a line.
        Vec normal = e.cross(f);
        for (const int l : in_plane)
          for (const int m : in_plane) {
            const Vec c = (points[l] - points[i]).cross(points[m] - points[i]);
            if (c.squaredNorm() > normal.squaredNorm())
              normal = (c.dot(e.cross(f)) < 0 ? Real(-1) : Real(1)) * c;
          }
        const Vec up = (above ? Real(-1) : Real(1)) * normal.normalized();
        in_plane = cornersOf(points, in_plane, up);
        hull.faces.push_back({up, in_plane});
        for (std::size_t c = 0; c < in_plane.size(); ++c) {
          const int l = in_plane[c], m = in_plane[(c + 1) % in_plane.size()];
          if (edges.insert({std::min(l, m), std::max(l, m)}).second) {
            hull.edges.push_back({l, m});
            addDirection(hull, points[m] - points[l]);
          }
        }
      }
  return hull;
}

inline Polytope polytopeOfBox(const Vec& half) {
  std::vector<Vec> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(half.cwiseProduct(Vec(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
  return hullOf(corners);
}

inline Mat rotationOf(const Pose& pose) {
  return Eigen::Quaternion<Real>(pose.q_WB.cast<Real>()).normalized().toRotationMatrix();
}

/// Seen from `origin`, in the axes of the world.
inline Polytope placed(Polytope polytope, const Pose& pose, const Vec3& origin) {
  const Mat R = rotationOf(pose);
  const Vec p = pose.p_WB.cast<Real>() - origin.cast<Real>();
  for (Vec& v : polytope.vertices) v = p + R * v;
  for (Polytope::Face& face : polytope.faces) face.normal = R * face.normal;
  for (Vec& direction : polytope.directions) direction = R * direction;
  return polytope;
}

/// What a pair of shapes is held against.
struct Truth {
  Real gap = kInfinity;        ///< distance; negative: depth
  Vec n = Vec::Zero();         ///< unit, from A to B; zero where there is none
  Real runner_up = kInfinity;  ///< depth along the best axis of another direction
};

/// From the segment p, p + u to the segment q, q + v, either of which may be a point.
inline Vec betweenSegments(const Vec& p, const Vec& u, const Vec& q, const Vec& v) {
  Vec best = q - p;
  const auto keep = [&](const Vec& r) {
    if (r.squaredNorm() < best.squaredNorm()) best = r;
  };
  const auto onto = [](const Vec& x, const Vec& a, const Vec& e) -> Vec {
    const Real ee = e.squaredNorm();
    return ee > 0 ? Vec(a + std::clamp((x - a).dot(e) / ee, Real(0), Real(1)) * e) : a;
  };
  keep(onto(p, q, v) - p);
  keep(onto(p + u, q, v) - (p + u));
  keep(q - onto(q, p, u));
  keep(q + v - onto(q + v, p, u));
  // Where the lines cross within both segments, the gap lies along the normal of both.
  Vec w = u.cross(v);
  for (int k = 0; k < 2 && w.squaredNorm() > 0; ++k) {  // of lines nearly parallel it keeps few digits
    w -= w.dot(u) / u.squaredNorm() * u;
    w -= w.dot(v) / v.squaredNorm() * v;
  }
  const Real ww = w.squaredNorm();
  if (ww > 0) {
    const Vec r = q - p;
    const Real s = r.cross(v).dot(w) / ww, t = r.cross(u).dot(w) / ww;
    if (s > 0 && s < 1 && t > 0 && t < 1) keep((r.dot(w) / ww) * w);
  }
  return best;
}

inline bool overFace(const Polytope& polytope, const Polytope::Face& face, const Vec& q) {
  for (std::size_t c = 0; c < face.corners.size(); ++c) {
    const Vec& l = polytope.vertices[face.corners[c]];
    const Vec& m = polytope.vertices[face.corners[(c + 1) % face.corners.size()]];
    if ((m - l).cross(q - l).dot(face.normal) < 0) return false;
  }
  return true;
}

/// From A to B, where these are apart.
inline Vec shortest(const Polytope& a, const Polytope& b) {
  Vec best = b.vertices[0] - a.vertices[0];
  const auto keep = [&](const Vec& r) {
    if (r.squaredNorm() < best.squaredNorm()) best = r;
  };
  const auto verticesOverFaces = [&](const Polytope& x, const Polytope& y, Real sign) {
    for (const Polytope::Face& face : x.faces)
      for (const Vec& q : y.vertices) {
        const Real height = face.normal.dot(q - x.vertices[face.corners[0]]);
        if (height >= 0 && height * height < best.squaredNorm() && overFace(x, face, q))
          keep(sign * height * face.normal);
      }
  };
  verticesOverFaces(a, b, 1);
  verticesOverFaces(b, a, -1);
  for (const auto& [i, j] : a.edges)
    for (const auto& [k, l] : b.edges)
      keep(betweenSegments(a.vertices[i], a.vertices[j] - a.vertices[i], b.vertices[k],
                           b.vertices[l] - b.vertices[k]));
  return best;
}

/// Separation of A and B along a unit direction from A to B.
inline Real separationAlong(const Polytope& a, const Polytope& b, const Vec& n) {
  Real top = -kInfinity, bottom = kInfinity;
  for (const Vec& v : a.vertices) top = std::max(top, n.dot(v));
  for (const Vec& v : b.vertices) bottom = std::min(bottom, n.dot(v));
  return bottom - top;
}

/// Axes nearer than this count as one.
inline constexpr Real kSameAxis = 1e-10L;

inline Truth polytopeGap(const Polytope& a, const Polytope& b) {
  Truth truth;
  if (a.faces.empty() && b.faces.empty()) {  // their difference is flat: it has no depth
    const Vec r = shortest(a, b);
    truth.gap = r.norm();
    if (truth.gap > 0) truth.n = r / truth.gap;
    return truth;
  }
  std::vector<std::pair<Real, Vec>> axes;
  const auto consider = [&](const Vec& n) {
    axes.emplace_back(separationAlong(a, b, n), n);
    axes.emplace_back(separationAlong(a, b, -n), -n);
  };
  for (const Polytope::Face& face : a.faces) consider(face.normal);
  for (const Polytope::Face& face : b.faces) consider(face.normal);
  const auto best = [&] {
    return *std::max_element(axes.begin(), axes.end(),
                             [](const auto& x, const auto& y) { return x.first < y.first; });
  };
  if (best().first <= 0)
    for (const Vec& u : a.directions)
      for (const Vec& v : b.directions) {
        Vec n = u.cross(v);
        if (n.norm() <= 4 * kRealEpsilon) continue;
        n.normalize();
        for (int k = 0; k < 2; ++k) {  // of edges nearly parallel the cross product keeps few digits
          n -= n.dot(u) * u;
          n -= n.dot(v) * v;
          n.normalize();
        }
        if (n.allFinite()) consider(n);
      }
  if (best().first > 0) {
    const Vec r = shortest(a, b);
    truth.gap = r.norm();
    truth.n = r / truth.gap;
    return truth;
  }
  std::tie(truth.gap, truth.n) = best();
  for (const auto& [separation, n] : axes)
    if ((n - truth.n).norm() > kSameAxis) truth.runner_up = std::min(truth.runner_up, -separation);
  return truth;
}

}  // namespace rbs::oracle

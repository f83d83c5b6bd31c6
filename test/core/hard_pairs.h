// SPDX-License-Identifier: BSD-3-Clause
// Pairs of shapes that are hard on collision detection, the truth about them, and the smallest pair that
// still fails.
#pragma once

#include "core/round_oracle.h"

#include <functional>
#include <iomanip>
#include <sstream>
#include <string>

namespace rbs::oracle {

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
};

/// The largest full extent of the two, m: what tolerances are fractions of.
inline double sizeOf(const Pair& pair) {
  return std::max(fullExtents(pair.a).maxCoeff(), fullExtents(pair.b).maxCoeff());
}

/// The hull of points with volume, as a shape; by brute force, about the origin of the points.
inline Shape hullShape(const std::vector<Vec3>& points) {
  std::vector<Vec> distinct;
  for (const Vec3& p : points)
    if (std::none_of(distinct.begin(), distinct.end(), [&](const Vec& q) { return q == p.cast<Real>(); }))
      distinct.push_back(p.cast<Real>());
  const Polytope hull = hullOf(distinct);
  if (hull.faces.size() < 4) throw std::invalid_argument("no volume");
  auto polyhedron = std::make_shared<Polyhedron>();
  std::vector<int> place(distinct.size(), -1);
  for (const Polytope::Face& face : hull.faces) {
    std::vector<int> corners;
    for (const int c : face.corners) {
      if (place[c] < 0) {
        place[c] = static_cast<int>(polyhedron->vertices.size());
        polyhedron->vertices.push_back(distinct[c].cast<double>());
      }
      corners.push_back(place[c]);
    }
    polyhedron->faces.push_back({face.normal.cast<double>(),
                                 static_cast<double>(face.normal.dot(distinct[face.corners[0]])), corners});
  }
  polyhedron->neighbours.resize(polyhedron->vertices.size());
  for (const auto& [i, j] : hull.edges) {
    polyhedron->neighbours[place[i]].push_back(place[j]);
    polyhedron->neighbours[place[j]].push_back(place[i]);
  }
  polyhedron->bounds = {polyhedron->vertices[0], polyhedron->vertices[0]};
  for (const Vec3& v : polyhedron->vertices) {
    polyhedron->bounds.lo = polyhedron->bounds.lo.cwiseMin(v);
    polyhedron->bounds.hi = polyhedron->bounds.hi.cwiseMax(v);
    polyhedron->bounding_radius = std::max(polyhedron->bounding_radius, v.norm());
  }
  return ConvexHull{polyhedron};
}

// --- truth

/// A shape as a core with a ball of some radius swept over it.
using Core = std::variant<Polytope, Revolved>;
struct RoundedCore {
  Core core;
  Real radius = 0;
};

inline const Polytope& hullOf(const std::shared_ptr<const Polyhedron>& polyhedron) {
  // Brute force is slow and the polyhedra are few.
  static std::vector<std::pair<std::shared_ptr<const Polyhedron>, Polytope>> known;
  for (const auto& [key, hull] : known)
    if (key == polyhedron) return hull;
  std::vector<Vec> points;
  for (const Vec3& v : polyhedron->vertices) points.push_back(v.cast<Real>());
  known.emplace_back(polyhedron, hullOf(points));
  return known.back().second;
}

inline RoundedCore coreOfShape(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return {polytopeOfPoint(), sphere->radius};
  if (const auto* box = std::get_if<Box>(&shape)) return {polytopeOfBox(0.5L * box->size.cast<Real>()), 0};
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return {polytopeOfSegment(capsule->half_length), capsule->radius};
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return {cylinderOf(cylinder->radius, cylinder->half_length), 0};
  if (const auto* cone = std::get_if<Cone>(&shape)) return {coneOf(cone->radius, cone->height), 0};
  return {hullOf(std::get<ConvexHull>(shape).polyhedron), 0};
}

/// What is true of a pair, given the direction that the code under test found. Where a solid of revolution
/// overlaps, that direction is tried too: whatever separates, separates.
struct Judged {
  Truth truth;
  Real along;       ///< separation along the direction that was found
  Real slack = 0;   ///< how much smaller than said the gap may be, where it is known from a certificate only
  Real radius = 0;  ///< of both balls together: gap + radius is the gap of the cores, which has the direction
};

inline Judged judge(const Pair& pair, const Vec3& found_n) {
  const Vec3 origin = pair.X_WA.p_WB;
  const RoundedCore a = coreOfShape(pair.a), b = coreOfShape(pair.b);
  const Vec n = found_n.cast<Real>().normalized();
  Judged judged = std::visit(
      [&](const auto& core_a, const auto& core_b) -> Judged {
        using A = std::decay_t<decltype(core_a)>;
        using B = std::decay_t<decltype(core_b)>;
        const auto x = placed(core_a, pair.X_WA, origin);
        const auto y = placed(core_b, pair.X_WB, origin);
        const Real along = separationAlong(x, y, n);
        if constexpr (std::is_same_v<A, Polytope> && std::is_same_v<B, Polytope>) {
          return {polytopeGap(x, y), along, 0, 0};
        } else {
          Vec r;
          Real proved, slack = 0;
          if constexpr (std::is_same_v<A, Polytope>) {
            r = shortest(x, y);
            proved = r.norm() > 0 ? separationAlong(x, y, r.normalized()) : 0;
          } else if constexpr (std::is_same_v<B, Polytope>) {
            r = -shortest(y, x);
            proved = r.norm() > 0 ? separationAlong(x, y, r.normalized()) : 0;
          } else {
            const Certified certified = certifiedDistance(x, y, n);
            r = certified.v;
            proved = certified.lower;
            slack = certified.upper - std::max(proved, along);
          }
          // Rounding turns the direction of a tiny gap; the found one, or a search, may prove better.
          if (std::max(proved, along) > 0) return {{r.norm(), r.normalized(), kInfinity}, along, slack, 0};
          const bool point = [&] {
            if constexpr (std::is_same_v<A, Polytope>) return x.vertices.size() == 1;
            if constexpr (std::is_same_v<B, Polytope>) return y.vertices.size() == 1;
            return false;
          }();
          if (point) {
            Vec outward;
            Real distance = 0;
            if constexpr (std::is_same_v<A, Polytope> && std::is_same_v<B, Revolved>)
              distance = y.signedDistance(x.vertices[0], &outward), outward = -outward;
            if constexpr (std::is_same_v<B, Polytope> && std::is_same_v<A, Revolved>)
              distance = x.signedDistance(y.vertices[0], &outward);
            return {{distance, outward, -distance}, along, 0, 0};  // no claim that the direction is unique
          }
          Truth truth = searchedDepth(x, y, n);
          if (truth.gap > 0) return {{r.norm(), truth.n, kInfinity}, along, slack, 0};
          truth.runner_up = -truth.gap;
          return {truth, along, 0, 0};
        }
      },
      a.core, b.core);
  const Real radius = a.radius + b.radius;
  judged.truth.gap -= radius;
  judged.truth.runner_up += radius;
  judged.along -= radius;
  judged.radius = radius;
  return judged;
}

// --- print

inline std::string number(double x) {
  std::ostringstream out;
  out << std::setprecision(17) << x;
  return out.str();
}
inline std::string text(const Vec3& v) {
  return "{" + number(v[0]) + ", " + number(v[1]) + ", " + number(v[2]) + "}";
}
inline std::string text(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return "Sphere{" + number(sphere->radius) + "}";
  if (const auto* box = std::get_if<Box>(&shape)) return "Box{" + text(box->size) + "}";
  if (const auto* c = std::get_if<Capsule>(&shape))
    return "Capsule{" + number(c->radius) + ", " + number(c->half_length) + "}";
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return "Cylinder{" + number(c->radius) + ", " + number(c->half_length) + "}";
  if (const auto* c = std::get_if<Cone>(&shape))
    return "Cone{" + number(c->radius) + ", " + number(c->height) + "}";
  std::string points;
  for (const Vec3& v : std::get<ConvexHull>(shape).polyhedron->vertices)
    points += (points.empty() ? "" : ", ") + text(v);
  return "hull({" + points + "})";
}
inline std::string text(const Pose& pose) {
  return "{" + text(pose.p_WB) + ", Quat(" + number(pose.q_WB.w()) + ", " + number(pose.q_WB.x()) + ", " +
         number(pose.q_WB.y()) + ", " + number(pose.q_WB.z()) + ")}";
}
/// As it can be pasted into a test.
inline std::string text(const Pair& pair) {
  return "{" + text(pair.a) + ",\n " + text(pair.b) + ",\n " + text(pair.X_WA) + ",\n " + text(pair.X_WB) +
         "}";
}

// --- shrink

inline double rounded(double x, int digits) {
  std::ostringstream out;
  out << std::setprecision(digits) << x;
  return std::stod(out.str());
}
inline Vec3 rounded(const Vec3& v, int digits) {
  return v.unaryExpr([&](double x) { return rounded(x, digits); });
}
inline Pose rounded(const Pose& pose, int digits) {
  const Eigen::Vector4d q = pose.q_WB.coeffs().unaryExpr([&](double x) { return rounded(x, digits); });
  return {rounded(pose.p_WB, digits), q.isZero(0.0) ? pose.q_WB : Quat(Quat(q).normalized())};
}
inline Shape rounded(const Shape& shape, int digits) {
  const auto f = [&](double x) { return rounded(x, digits); };
  if (const auto* s = std::get_if<Sphere>(&shape)) return Sphere{f(s->radius)};
  if (const auto* s = std::get_if<Box>(&shape)) return Box{rounded(s->size, digits)};
  if (const auto* s = std::get_if<Capsule>(&shape)) return Capsule{f(s->radius), f(s->half_length)};
  if (const auto* s = std::get_if<Cylinder>(&shape)) return Cylinder{f(s->radius), f(s->half_length)};
  if (const auto* s = std::get_if<Cone>(&shape)) return Cone{f(s->radius), f(s->height)};
  std::vector<Vec3> points = std::get<ConvexHull>(shape).polyhedron->vertices;
  for (Vec3& v : points) v = rounded(v, digits);
  return hullShape(points);
}

/// Simpler pairs, simplest first.
inline std::vector<Pair> simpler(const Pair& pair) {
  std::vector<Pair> candidates;
  const auto with = [&](const auto& change) {
    Pair other = pair;
    try {
      change(other);
    } catch (const std::exception&) {
      return;  // no such hull
    }
    if (text(other).size() < text(pair).size()) candidates.push_back(other);
  };
  with([](Pair& p) {
    p.X_WB = {p.X_WA.q_WB.conjugate() * (p.X_WB.p_WB - p.X_WA.p_WB),
              (p.X_WA.q_WB.conjugate() * p.X_WB.q_WB).normalized()};
    p.X_WA = Pose();
  });
  with([](Pair& p) { p.X_WB.p_WB -= p.X_WA.p_WB, p.X_WA.p_WB.setZero(); });
  with([](Pair& p) { p.X_WB.q_WB.setIdentity(); });
  with([](Pair& p) { p.X_WA.q_WB.setIdentity(); });
  for (int axis = 0; axis < 3; ++axis) with([&](Pair& p) { p.X_WB.p_WB[axis] = 0.0; });
  for (Shape Pair::*side : {&Pair::a, &Pair::b})
    if (const auto* hull = std::get_if<ConvexHull>(&(pair.*side)))
      for (std::size_t k = 0; k < hull->polyhedron->vertices.size(); ++k)
        with([&](Pair& p) {
          std::vector<Vec3> points = std::get<ConvexHull>(p.*side).polyhedron->vertices;
          points.erase(points.begin() + static_cast<std::ptrdiff_t>(k));
          p.*side = hullShape(points);
        });
  for (const int digits : {1, 2, 3, 5, 8, 12}) {
    with([&](Pair& p) { p.a = rounded(p.a, digits); });
    with([&](Pair& p) { p.b = rounded(p.b, digits); });
    with([&](Pair& p) { p.X_WA = rounded(p.X_WA, digits); });
    with([&](Pair& p) { p.X_WB.p_WB = rounded(p.X_WB.p_WB, digits); });
    with([&](Pair& p) { p.X_WB.q_WB = rounded(p.X_WB, digits).q_WB; });
  }
  return candidates;
}

/// `fault` says what is wrong with a pair, or nothing.
inline Pair shrunk(Pair pair, const std::function<std::string(const Pair&)>& fault) {
  for (int round = 0; round < 60; ++round) {
    bool smaller = false;
    for (const Pair& candidate : simpler(pair))
      if (!fault(candidate).empty()) {
        pair = candidate;
        smaller = true;
        break;
      }
    if (!smaller) break;
  }
  return pair;
}

// --- sample

/// Full extents over 1 : 1 to 1 : 1e4, the largest about 1.
inline Vec3 randomExtents(Random& random) {
  Vec3 extents;
  const double decades = random.below(2) == 0 ? 0.5 : 4.0;
  for (int k = 0; k < 3; ++k) extents[k] = std::pow(10.0, -random.uniform(0.0, decades));
  switch (random.below(8)) {
    case 0:
      return Vec3::Ones();  // cube
    case 1:
      return Vec3(1.0, 1.0, extents[2]);  // plate
    case 2:
      return Vec3(extents[0], extents[0], 1.0);  // needle
    default:
      return extents / extents.maxCoeff();
  }
}

inline Shape randomShape(Random& random, const std::string& kind) {
  const Vec3 e = randomExtents(random);
  if (kind == "sphere") return Sphere{0.5 * e[0]};
  if (kind == "box") return Box{e};
  if (kind == "capsule") return Capsule{0.5 * e[0], random.below(20) == 0 ? 0.0 : 0.5 * e[2]};
  if (kind == "cylinder") return Cylinder{0.5 * e[0], 0.5 * e[2]};
  if (kind == "cone") return Cone{0.5 * e[0], e[2]};
  // A hull out of a store, since it takes long to make one.
  static std::vector<Shape> store;
  if (store.size() < 300) {
    for (;;) {
      std::vector<Vec3> points;
      const int n = 4 + random.below(random.below(4) == 0 ? 17 : 7);
      const bool ball = random.below(2) == 0, grid = random.below(4) == 0;
      for (int k = 0; k < n; ++k) {
        Vec3 point = ball ? Vec3(0.5 * random.direction()) : random.inCube(0.5);
        if (grid) point = (4.0 * point).array().round() / 4.0;  // coplanar faces, parallel edges
        points.push_back(e.cwiseProduct(point));
      }
      try {
        store.push_back(hullShape(points));
        return store.back();
      } catch (const std::exception&) {
        continue;  // too flat
      }
    }
  }
  return store[static_cast<std::size_t>(random.below(static_cast<int>(store.size())))];
}

inline double tiny(Random& random) {
  return std::pow(10.0, -random.uniform(3.0, 16.0));
}
inline Quat turnedBy(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}
/// One of the 24 turns of a cube.
inline Quat quarterTurns(Random& random) {
  Quat q = Quat::Identity();
  for (int axis = 0; axis < 3; ++axis) q = turnedBy(0.5 * EIGEN_PI * random.below(4), Vec3::Unit(axis)) * q;
  return q.normalized();
}

inline Pair randomPair(Random& random, const std::string& kind_a, const std::string& kind_b) {
  Pair pair{randomShape(random, kind_a), randomShape(random, kind_b), {}, {}};
  if (random.below(4) == 0) pair.b = scaled(pair.b, std::pow(10.0, -random.uniform(0.0, 4.0)));
  const double reach = 0.5 * (fullExtents(pair.a).norm() + fullExtents(pair.b).norm());
  Quat q_AB = random.orientation();
  switch (random.below(6)) {
    case 0:  // faces that kiss: turned by little or nothing
      q_AB = quarterTurns(random);
      if (random.below(2) == 0) q_AB = turnedBy(tiny(random), random.direction()) * q_AB;
      break;
    case 1:  // edges that are parallel, or nearly
      q_AB = turnedBy(random.uniform(0.0, 6.0), Vec3::Unit(random.below(3))) * quarterTurns(random);
      if (random.below(2) == 0) q_AB = turnedBy(tiny(random), random.direction()) * q_AB;
      break;
    default:
      break;
  }
  Vec3 p_AB;
  switch (random.below(8)) {
    case 0:  // concentric, or nearly
      p_AB = random.below(2) == 0 ? Vec3(Vec3::Zero()) : Vec3(tiny(random) * reach * random.direction());
      break;
    case 1:  // far
      p_AB = std::pow(10.0, random.uniform(0.0, 5.0)) * reach * random.direction();
      break;
    case 2:  // straight along an axis
      p_AB = random.uniform(0.0, 1.0) * reach * Vec3::Unit(random.below(3));
      break;
    default:
      p_AB = random.uniform(0.0, 1.0) * reach * random.direction();
      break;
  }
  pair.X_WB = {p_AB, q_AB.normalized()};
  if (random.below(2) == 0) {
    // B is moved along the normal until the gap is tiny, or nothing, on either side.
    const Truth truth = judge(pair, Vec3::UnitX()).truth;
    double gap = random.below(8) == 0 ? 0.0 : tiny(random) * sizeOf(pair);
    if (random.below(2) == 0) gap = -gap;
    if (truth.n.allFinite()) pair.X_WB.p_WB += ((gap - truth.gap) * truth.n).cast<double>();
  }
  if (random.below(2) == 0) {  // somewhere else in the world
    const Pose by{random.inCube(reach), random.orientation()};
    pair.X_WA = moved(by, pair.X_WA);
    pair.X_WB = moved(by, pair.X_WB);
  }
  return pair;
}

}  // namespace rbs::oracle

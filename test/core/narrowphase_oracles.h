// SPDX-License-Identifier: BSD-3-Clause
// Slow and obvious answers in long double to hold the narrow phase against, and random pairs to ask about.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rbs::oracle {

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;
using Mat = Eigen::Matrix<Real, 3, 3>;

/// A box in the world.
struct PlacedBox {
  Vec half, p;
  Mat R;

  PlacedBox(const Box& box, const Pose& pose)
      : half(0.5L * box.size.cast<Real>()),
        p(pose.p_WB.cast<Real>()),
        R(Eigen::Quaternion<Real>(pose.q_WB.cast<Real>()).normalized().toRotationMatrix()) {}

  Vec corner(int k) const {
    return p + R * half.cwiseProduct(Vec(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  }
  Vec toBody(const Vec& q) const { return R.transpose() * (q - p); }
  Real distanceTo(const Vec& q) const {
    const Vec b = toBody(q);
    return (b - b.cwiseMax(-half).cwiseMin(half)).norm();
  }
  Real reach(const Vec& direction) const { return (R.transpose() * direction).cwiseAbs().dot(half); }
};

inline Real segmentDistance(const Vec& p, const Vec& u, const Vec& q, const Vec& v) {
  // Both ends of each against the other, and the crossing of the lines where it lies on both.
  const auto pointToSegment = [](const Vec& x, const Vec& a, const Vec& e) {
    const Real t = std::clamp((x - a).dot(e) / e.squaredNorm(), Real(0), Real(1));
    return (x - a - t * e).norm();
  };
  Real best = std::min({pointToSegment(p, q, v), pointToSegment(p + u, q, v), pointToSegment(q, p, u),
                        pointToSegment(q + v, p, u)});
  const Vec r = q - p;
  const Real uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), det = uu * vv - uv * uv;
  if (det > 1e-24L * uu * vv) {
    const Real s = (r.dot(u) * vv - r.dot(v) * uv) / det, t = (r.dot(u) * uv - r.dot(v) * uu) / det;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) best = std::min(best, (r + t * v - s * u).norm());
  }
  return best;
}

/// Distance of two boxes known to be apart: every corner against every box, every edge against every edge.
inline Real boxDistance(const PlacedBox& a, const PlacedBox& b) {
  Real best = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < 8; ++k) best = std::min({best, a.distanceTo(b.corner(k)), b.distanceTo(a.corner(k))});
  for (int i = 0; i < 8; ++i)
    for (int di : {1, 2, 4})
      for (int j = 0; j < 8; ++j)
        for (int dj : {1, 2, 4})
          if (!(i & di) && !(j & dj))
            best = std::min(best, segmentDistance(a.corner(i), a.corner(i | di) - a.corner(i), b.corner(j),
                                                  b.corner(j | dj) - b.corner(j)));
  return best;
}

/// Separation along a unit direction.
inline Real separationAlong(const PlacedBox& a, const PlacedBox& b, const Vec& n) {
  return n.dot(b.p - a.p) - a.reach(n) - b.reach(n);
}

/// The largest separation over the fifteen axes: negative depth where the boxes overlap.
inline Real farthestSeparation(const PlacedBox& a, const PlacedBox& b) {
  std::vector<Vec> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.R.col(i));
    axes.push_back(b.R.col(i));
    for (int j = 0; j < 3; ++j) axes.push_back(a.R.col(i).cross(b.R.col(j)));
  }
  Real best = -std::numeric_limits<Real>::infinity();
  for (const Vec& axis : axes) {
    if (axis.norm() < 1e-6L) continue;
    const Vec n = axis.normalized();
    best = std::max({best, separationAlong(a, b, n), separationAlong(a, b, -n)});
  }
  return best;
}

/// Signed gap of two boxes.
inline Real boxGap(const PlacedBox& a, const PlacedBox& b) {
  const Real separation = farthestSeparation(a, b);
  return separation > 0 ? boxDistance(a, b) : separation;
}

/// Random things, from a seed that a failing test prints.
class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(generator_); }
  Vec3 inCube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return Vec3(normal(generator_), normal(generator_), normal(generator_)).normalized();
  }
  Quat orientation() {
    std::normal_distribution<double> normal;
    return Quat(normal(generator_), normal(generator_), normal(generator_), normal(generator_)).normalized();
  }
  Pose pose(double reach) { return {inCube(reach), orientation()}; }
  /// Cubes, slabs, needles and boxes of any proportion up to 1 : 100.
  Box box() {
    const Vec3 sizes[] = {{1, 1, 1}, {1, 1, 0.02}, {0.02, 0.02, 1}, {0.3, 1, 0.6}};
    const int kind = below(5);
    if (kind < 4) return Box{sizes[kind]};
    return Box{
        {std::pow(10.0, uniform(-2, 0)), std::pow(10.0, uniform(-2, 0)), std::pow(10.0, uniform(-2, 0))}};
  }

 private:
  std::mt19937_64 generator_;
};

inline Pose moved(const Pose& by, const Pose& pose) {
  return {by.p_WB + by.q_WB * pose.p_WB, (by.q_WB * pose.q_WB).normalized()};
}

}  // namespace rbs::oracle

// SPDX-License-Identifier: BSD-3-Clause
// Spheres against spheres, boxes and planes: one point each, in closed form.
#include "narrowphase/pairs.h"

namespace rbs {

namespace {

// Centres nearer than this fraction of the size have no direction to speak of.
constexpr double kCoincident = 1e-30;

// From the centre of a sphere, along `n_W`, its surface lies at `radius` and the other one `distance` beyond.
Gap gapFrom(const Vec3& centre_W, double radius, double distance, const Vec3& n_W) {
  return {distance, n_W, centre_W + radius * n_W, centre_W + (radius + distance) * n_W};
}

Manifold onePoint(const Gap& gap, double margin) {
  Manifold manifold;
  manifold.n_W = gap.n_W;
  if (gap.distance <= margin) manifold.add(0.5 * (gap.p_WA + gap.p_WB), gap.distance, 0);
  return manifold;
}

}  // namespace

Gap gapPair(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB) {
  const Vec3 p_AB_W = X_WB.p_WB - X_WA.p_WB;
  const double distance = p_AB_W.norm(), touching = a.radius + b.radius;
  const Vec3 n_W = distance > kCoincident * touching ? Vec3(p_AB_W / distance) : Vec3(Vec3::UnitZ());
  return gapFrom(X_WA.p_WB, a.radius, distance - touching, n_W);
}

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB, double margin) {
  return onePoint(gapPair(a, X_WA, b, X_WB), margin);
}

// Outside, the nearest point of the box is the centre clamped to it, axis by axis. Inside, the way out is
// through the nearest face, and the first of several.
Gap gapPair(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB) {
  const Vec3 half = 0.5 * b.size;
  const Vec3 centre_B = X_WB.q_WB.conjugate() * (X_WA.p_WB - X_WB.p_WB);
  const Vec3 outside_B = centre_B - centre_B.cwiseMax(-half).cwiseMin(half);
  const double distance = outside_B.norm();
  if (distance > kCoincident * a.radius)
    return gapFrom(X_WA.p_WB, a.radius, distance - a.radius, X_WB.q_WB * (outside_B / -distance));

  Eigen::Index face;
  const double depth = (half - centre_B.cwiseAbs()).minCoeff(&face);
  const Vec3 inward_B = (centre_B[face] < 0.0 ? 1.0 : -1.0) * Vec3::Unit(face);
  return gapFrom(X_WA.p_WB, a.radius, -depth - a.radius, X_WB.q_WB * inward_B);
}

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin) {
  return onePoint(gapPair(a, X_WA, b, X_WB), margin);
}

Gap gapPair(const Sphere& a, const Pose& X_WA, const Plane& /*b*/, const Pose& X_WB) {
  const Vec3 up_W = X_WB.q_WB * Vec3::UnitZ();
  return gapFrom(X_WA.p_WB, a.radius, up_W.dot(X_WA.p_WB - X_WB.p_WB) - a.radius, -up_W);
}

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Plane& b, const Pose& X_WB, double margin) {
  return onePoint(gapPair(a, X_WA, b, X_WB), margin);
}

}  // namespace rbs

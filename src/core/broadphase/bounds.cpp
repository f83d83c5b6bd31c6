#include "broadphase/bounds.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

constexpr double kSkin = 0.01;  // of a body's length L

// How far a body reaches from its centre along the rows of D (3 x n unit directions as columns).
template <int N>
Eigen::Matrix<double, N, 1> reach(const Bodies& bodies, Index i, const Eigen::Matrix<double, 3, N>& D) {
  const Traits& t = bodies.traits[i];
  if (const auto* box = std::get_if<Box>(&t.shape)) {
    const Mat3 half_edges_W = bodies.R_WB(i) * (0.5 * box->size).asDiagonal();
    return (D.transpose() * half_edges_W).cwiseAbs().rowwise().sum();
  }
  return Eigen::Matrix<double, N, 1>::Constant(t.bounding_radius);
}

// A point at distance r from the centre strays at most |w| dt r from where it would be without rotation,
// and never leaves the bounding ball.
double strayed(double reach, const Traits& t, const Twist& twist, double dt) {
  if (std::holds_alternative<Sphere>(t.shape)) return reach;
  return std::min(reach + dt * twist.w_WB.norm() * t.bounding_radius, t.bounding_radius);
}

// The displacement over dt, and how far the path bulges from the straight line between its ends: a parabola
// over dt bulges by |a| dt²/8.
struct Path {
  Vec3 displacement;
  double slack;
};

Path pathOver(const Bodies& bodies, const Load& load, Index i, double dt) {
  const double bulge = 0.125 * dt * dt * load.a_W.norm();
  return {dt * (bodies.twist[i].v_WB + 0.5 * dt * load.a_W), bulge + kSkin * bodies.traits[i].length};
}

}  // namespace

Aabb sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt) {
  const Traits& t = bodies.traits[i];
  const Vec3& p = bodies.pose[i].p_WB;
  const Path path = pathOver(bodies, load, i, dt);
  Vec3 half = reach<3>(bodies, i, Mat3::Identity());
  for (int k = 0; k < 3; ++k) half[k] = strayed(half[k], t, bodies.twist[i], dt) + path.slack;
  return {p + path.displacement.cwiseMin(0.0) - half, p + path.displacement.cwiseMax(0.0) + half};
}

Interval diagonalInterval(const Bodies& bodies, const Load& load, Index i, double dt) {
  static const Vec3 d = Vec3::Ones() / std::sqrt(3.0);
  const Path path = pathOver(bodies, load, i, dt);
  const double centre = d.dot(bodies.pose[i].p_WB);
  const double shift = d.dot(path.displacement);
  const double half = strayed(reach<1>(bodies, i, d)[0], bodies.traits[i], bodies.twist[i], dt) + path.slack;
  return {centre + std::min(shift, 0.0) - half, centre + std::max(shift, 0.0) + half};
}

}  // namespace rbs

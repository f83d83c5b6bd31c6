#include "broadphase/bounds.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

constexpr double kSkin = 0.01;  // of a body's length L

/// How far a body reaches from its centre along N directions, and against them.
template <int N>
struct Reach {
  Eigen::Matrix<double, N, 1> ahead, behind;
};

// D has the N unit directions as columns.
template <int N>
Reach<N> reachAlong(const Bodies& bodies, Index i, const Eigen::Matrix<double, 3, N>& D) {
  const Traits& t = bodies.traits[i];
  Reach<N> result;
  if (std::holds_alternative<Sphere>(t.shape)) {
    result.ahead.setConstant(t.bounding_radius);
    result.behind = result.ahead;
  } else if (const auto* box = std::get_if<Box>(&t.shape)) {
    const Mat3 half_edges_W = bodies.R_WB(i) * (0.5 * box->size).asDiagonal();
    result.ahead = (D.transpose() * half_edges_W).cwiseAbs().rowwise().sum();
    result.behind = result.ahead;
  } else {
    const Eigen::Matrix<double, 3, N> D_B = bodies.R_WB(i).transpose() * D;
    for (int k = 0; k < N; ++k) {
      result.ahead[k] = reach(t.shape, D_B.col(k));
      result.behind[k] = reach(t.shape, -D_B.col(k));
    }
  }
  return result;
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
  Reach<3> far = reachAlong<3>(bodies, i, Mat3::Identity());
  for (int k = 0; k < 3; ++k) {
    far.ahead[k] = strayed(far.ahead[k], t, bodies.twist[i], dt) + path.slack;
    far.behind[k] = strayed(far.behind[k], t, bodies.twist[i], dt) + path.slack;
  }
  return {p + path.displacement.cwiseMin(0.0) - far.behind, p + path.displacement.cwiseMax(0.0) + far.ahead};
}

Interval diagonalInterval(const Bodies& bodies, const Load& load, Index i, double dt) {
  static const Vec3 d = Vec3::Ones() / std::sqrt(3.0);
  const Path path = pathOver(bodies, load, i, dt);
  const double centre = d.dot(bodies.pose[i].p_WB);
  const double shift = d.dot(path.displacement);
  const Reach<1> far = reachAlong<1>(bodies, i, d);
  const auto length = [&](double reach) {
    return strayed(reach, bodies.traits[i], bodies.twist[i], dt) + path.slack;
  };
  return {centre + std::min(shift, 0.0) - length(far.behind[0]),
          centre + std::max(shift, 0.0) + length(far.ahead[0])};
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/bounds.h"

#include "dynamics/free_top.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

constexpr double kSkin = 0.01;  // of a body's length L

using Array4 = Bounds::Array4;

const Vec3 kDiagonal = Vec3::Ones() / std::sqrt(3.0);

Array4 alongAxes(const Vec3& v) {
  return {v.x(), v.y(), v.z(), kDiagonal.dot(v)};
}

// How far a body reaches from its centre along the axes, and against them.
struct Reach {
  Array4 ahead, behind;
};

Reach reachOf(const Bodies& bodies, Index i) {
  const Traits& t = bodies.traits[i];
  if (t.round) {
    const Array4 radius = Array4::Constant(t.bounding_radius);
    return {radius, radius};
  }
  const Mat3 R_WB = bodies.R_WB(i);
  if (const auto* box = std::get_if<Box>(&t.shape)) {
    const Mat3 half_edges_W = R_WB * (0.5 * box->size).asDiagonal();
    Array4 half;
    half << half_edges_W.cwiseAbs().rowwise().sum(), (kDiagonal.transpose() * half_edges_W).cwiseAbs().sum();
    return {half, half};
  }
  Reach far;
  for (int k = 0; k < 4; ++k) {
    const Vec3 d_B = R_WB.transpose() * (k < 3 ? Vec3(Vec3::Unit(k)) : kDiagonal);
    far.ahead[k] = reach(t.shape, d_B);
    far.behind[k] = reach(t.shape, -d_B);
  }
  return far;
}

// A point at distance r from the centre strays at most |w| dt r from where it would be without rotation,
// and never leaves the bounding ball.
Array4 drifted(const Array4& reach, const Traits& t, double turn) {
  if (turn == 0.0 || t.round) return reach;
  return (reach + turn * t.bounding_radius).min(t.bounding_radius);
}

// How far a body may turn in dt, rad: the spin of one that is no ball grows to what spinBoundsOf() says, and a torque T turns
// it by |I^-1 T| dt²/2 more.
double mostTurn(const Bodies& bodies, const Load& load, Index i, double dt) {
  const Inertia& inertia = bodies.inertia[i];
  const Vec3& w_W = bodies.twist[i].w_WB;
  const bool grows = bodies.traits[i].moved_by_forces() && !inertia.isotropic && !inertia.steady;
  const double spin =
      grows && !w_W.isZero(0.0) ? spinBoundsOf(bodies.pose[i].q_WB.conjugate() * w_W, inertia).w : w_W.norm();
  if (load.torque_W.isZero(0.0)) return dt * spin;
  return dt * (spin + 0.5 * dt * inertia.inv_moments.maxCoeff() * load.torque_W.norm());
}

}  // namespace

// The path over dt bulges from the straight line between its ends: a parabola by |a| dt²/8.
Bounds sweptBounds(const Bodies& bodies, const Load& load, Index i, double dt) {
  const Traits& t = bodies.traits[i];
  const Twist& twist = bodies.twist[i];
  const Array4 centre = alongAxes(bodies.pose[i].p_WB);
  const Array4 path = alongAxes(dt * (twist.v_WB + 0.5 * dt * load.a_W));
  const double slack = 0.125 * dt * dt * load.a_W.norm() + kSkin * t.length;
  const double turn = mostTurn(bodies, load, i, dt);
  const Reach far = reachOf(bodies, i);
  return {centre + path.min(0.0) - drifted(far.behind, t, turn) - slack,
          centre + path.max(0.0) + drifted(far.ahead, t, turn) + slack};
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Bounds for conservative advancement: B. Mirtich, "Impulse-based dynamic simulation of rigid body systems",
// PhD thesis, Berkeley, 1996. The separation of the bodies along a direction n(s) that turns with a constant
// angular velocity w_n, n(s) = exp(w_n s) n, is known at any s from their support functions, without a search
// for the nearest points. Two lower bounds of it lead from one s to the next.
//
// 1. Of the swept bodies, for a fixed n: a spinning body never leaves the solid of revolution about its spin,
//    so only the centres move, and n.p(s) is a parabola.
//
// 2. Of second order. For a point r of the core of body X, seen from its centre, u(s) = n(s).r(s) has
//      u'(0) = r.m  with  m = n x (w_X - w_n),      |u''| <= k |r|,
//      k = 0 if w_n = w_X,  |w_X| |w_X x n| if w_n = 0,  (|w_X| + |w_n|)² else,
//    so with x = p_B - p_A and h_X(d) = max over X of d.r
//      separation(s) >= n(s).x(s) - h_A(n + s m_A) - h_B(-(n + s m_B)) - k s²/2.
//    It agrees with the motion to first order, so that advancing by it converges like Newton's method. It is
//    concave: its chords lie below it, its tangents above.
//
// A body of revolution that spins about its axis with w_r looks the same as one that does not: w_X is what
// turns the axis, of constant length but turning with w_r itself, so that k = (|w_X| + |w_n|)² + |w_r| |w_X|.
//
// The w_X of a free top is not constant. With W and W' bounds of |w_X| and of |w_X'| for all times,
//   k = (W + |w_n|)² + W',
// and |w_r| |w_X| more where the spin about the axis is left out. What it sweeps is within its bounding
// sphere.
#include "narrowphase/safe_step.h"

#include "base/algebra.h"
#include "narrowphase/parabola.h"
#include "shapes/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

namespace rbs {

namespace {

bool isPlane(const MovingShape& x) {
  return std::holds_alternative<Plane>(x.shape);
}

// The spin as far as it moves the surface, with bounds of it for all times, and the rate of the rest of it.
struct Spin {
  Vec3 w;
  SpinBounds most;
  double roll = 0.0;
};

Spin spinOf(const MovingShape& x) {
  if (std::holds_alternative<Sphere>(x.shape)) return {Vec3::Zero(), {}};
  if (!traitsOf(x.shape).revolved) return {x.w_W, x.most};
  const Vec3 axis = x.R_WB.col(2);
  const double roll = axis.dot(x.w_W);
  const Vec3 w = x.w_W - roll * axis;  // of constant length: such a body is symmetric about its axis
  return {w, {w.norm(), x.most.change}, std::abs(roll)};
}

double curvature(const Spin& spin, const Vec3& w_n, const Vec3& n) {
  if (spin.most.change == 0.0 && spin.roll == 0.0) {
    if (spin.w == w_n) return 0.0;
    if (w_n.isZero(0.0)) return spin.most.w * spin.w.cross(n).norm();
  }
  const double sum = spin.most.w + w_n.norm();
  return sum * sum + spin.roll * spin.most.w + spin.most.change;
}

// The ball swept over the core of a shape. Of a plane, only the points below its origin are looked at.
double roundingOf(const MovingShape& x) {
  return std::visit(
      [](const auto& shape) {
        if constexpr (std::is_same_v<decltype(shape), const Plane&>)
          return 0.0;
        else
          return coreRadius(shape);
      },
      x.shape);
}

double coreExtent(const MovingShape& x) {
  return isPlane(x) ? 0.0 : boundingRadius(x.shape) - roundingOf(x);
}

// How far the core of a body reaches along d, and how that grows with s when d is n + s m.
struct Reach {
  double value = 0.0, slope = 0.0;
};

Reach reachAlong(const MovingShape& x, const Vec3& d, const Vec3& m) {
  if (isPlane(x)) return {};
  const Vec3 d_B = x.R_WB.transpose() * d;
  const Vec3 farthest_B = std::visit(
      [&](const auto& shape) -> Vec3 {
        if constexpr (std::is_same_v<decltype(shape), const Plane&>)
          return Vec3::Zero();
        else
          return coreOf(shape)(d_B);
      },
      x.shape);
  return {farthest_B.dot(d_B), farthest_B.dot(x.R_WB.transpose() * m)};
}

// The reach along n of the solid that the body sweeps as it spins.
double sweptReach(const MovingShape& x, const Vec3& n) {
  const double rate = x.w_W.norm();
  if (rate == 0.0 || isPlane(x)) return reachAlong(x, n, Vec3::Zero()).value + roundingOf(x);
  if (x.motion.top != nullptr) return boundingRadius(x.shape);
  const Vec3 axis_B = x.R_WB.transpose() * (x.w_W / rate);
  const double along = n.dot(x.w_W) / rate;
  const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
  const auto swept = [&](const Vec3& r) { return along * axis_B.dot(r) + across * axis_B.cross(r).norm(); };
  const auto onAxis = [](double z) { return Vec3(0.0, 0.0, z); };
  if (const auto* capsule = std::get_if<Capsule>(&x.shape))
    return std::max(swept(onAxis(capsule->half_length)), swept(onAxis(-capsule->half_length))) +
           capsule->radius;
  if (const auto* cylinder = std::get_if<Cylinder>(&x.shape))
    return std::max(swept(onAxis(cylinder->half_length)), swept(onAxis(-cylinder->half_length))) +
           cylinder->radius;
  if (const auto* cone = std::get_if<Cone>(&x.shape))
    return std::max(swept(onAxis(0.75 * cone->height)), swept(onAxis(-0.25 * cone->height)) + cone->radius);
  double reach = 0.0;
  if (const auto* box = std::get_if<Box>(&x.shape)) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 signs(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      reach = std::max(reach, swept(box->size.cwiseProduct(signs)));
    }
  } else if (const auto* hull = std::get_if<ConvexHull>(&x.shape)) {
    for (const Vec3& vertex : hull->polyhedron->vertices) reach = std::max(reach, swept(vertex));
  } else {
    reach = boundingRadius(x.shape);  // of a ball, that is it
  }
  return reach;
}

// The bound of second order.
class ConcaveBound {
 public:
  ConcaveBound(const MovingShape& a, const MovingShape& b, const Vec3& n, const Vec3& w_n, double horizon)
      : a_(a), b_(b), n_(n), horizon_(horizon) {
    const Spin spin_a = spinOf(a), spin_b = spinOf(b);
    m_a_ = n.cross(spin_a.w - w_n), m_b_ = n.cross(spin_b.w - w_n);
    const Vec3 x = b.X_WB.p_WB - a.X_WB.p_WB, v = b.v_W - a.v_W, acceleration = b.a_W - a.a_W;
    const double loss = curvature(spin_a, w_n, n) * coreExtent(a) + curvature(spin_b, w_n, n) * coreExtent(b);
    double bend = n.dot(acceleration);
    if (const double turn = w_n.norm(); turn > 0.0) {
      // (n.x)'' = n''.x + 2 n'.x' + n.x'', with the largest |x| and |x'| up to the horizon. That is not
      // farther than the loss by n'' leads.
      horizon_ = std::min(horizon_, 2.0 / turn);
      const double speed = v.norm() + horizon_ * acceleration.norm(), distance = x.norm() + horizon_ * speed;
      bend = -(turn * turn * distance + 2.0 * turn * speed + acceleration.norm());
    }
    bend_ = std::min(bend - loss, 0.0);
    slope_ = n.dot(v) + w_n.cross(n).dot(x);
    offset_ = n.dot(x) - roundingOf(a) - roundingOf(b);
  }

  // Value and slope at s.
  Reach at(double s) const {
    const Reach reach_a = reachAlong(a_, n_ + s * m_a_, m_a_);
    const Reach reach_b = reachAlong(b_, -(n_ + s * m_b_), -m_b_);
    return {offset_ + s * (slope_ + 0.5 * s * bend_) - reach_a.value - reach_b.value,
            slope_ + s * bend_ - reach_a.slope - reach_b.slope};
  }

  // A time, at most the horizon, up to which the bound stays at or above `floor`: between the root of a
  // chord, which is early, and that of a tangent, which is late, until they nearly agree.
  double timeAbove(double floor) const {
    constexpr double kAgreed = 1e-2;
    const Reach now = at(0.0);
    double early = 0.0, above = now.value - floor;
    if (!(above > 0.0)) return 0.0;
    double late = std::min(horizon_, firstFall(above, now.slope, bend_).value_or(horizon_));
    for (int k = 0; k < 50; ++k) {
      const Reach end = at(late);
      const double below = end.value - floor;
      if (below >= 0.0) return late;
      early += (late - early) * (above / (above - below));
      above = at(early).value - floor;
      const double tangent = late - below / end.slope;
      if (!(above > 0.0) || !(tangent - early > kAgreed * tangent)) break;
      late = tangent;
    }
    return early;
  }

 private:
  const MovingShape &a_, &b_;
  Vec3 n_, m_a_, m_b_;
  double horizon_, offset_, slope_, bend_;
};

MovingShape later(const MovingShape& x, double s) {
  return {x.shape, x.motion, x.t + s};
}

}  // namespace

MovingShape::MovingShape(const Shape& moved, const Motion& along, double time)
    : shape(moved), motion(along), t(time), a_W(along.a_W), most(along.spinBounds()) {
  Twist twist;
  std::tie(X_WB, twist) = along.stateAt(time);
  R_WB = X_WB.q_WB.toRotationMatrix();
  v_W = twist.v_WB, w_W = twist.w_WB;
}

double timeApart(const MovingShape& a0, const MovingShape& b0, const Vec3& n_W, const Vec3& turn_W,
                 bool touches, const Levels& levels, double horizon) {
  // A direction is left where little of the separation is left: another one will be better by then.
  constexpr double kWorth = 1e-3;
  constexpr int kSteps = 1000;
  const double swept = turn_W.isZero(0.0) ? sweptReach(a0, n_W) + sweptReach(b0, -n_W)
                                          : std::numeric_limits<double>::infinity();
  double s = 0.0, closed = levels.closed;
  for (int k = 0; k < kSteps; ++k) {
    const MovingShape a = later(a0, s), b = later(b0, s);
    const Vec3 n = rotationBy(s * turn_W) * n_W;
    const ConcaveBound bound(a, b, n, turn_W, horizon - s);
    const Reach now = bound.at(0.0);
    if (k == 0) closed = std::max(closed, kWorth * now.value);
    touches = touches && now.value <= levels.free;
    if (touches ? k > 0 && now.slope <= 0.0 : now.value <= closed) break;
    double step = bound.timeAbove(touches ? levels.floor : 0.0);
    if (touches) {
      if (bound.at(step).slope * step < -levels.free) step *= 0.5;  // what is thrown up turns round half-way
    } else if (const double gap = n.dot(b.X_WB.p_WB - a.X_WB.p_WB) - swept; gap > 0.0) {
      step = std::max(step, firstFall(gap, n.dot(b.v_W - a.v_W), n.dot(b.a_W - a.a_W)).value_or(horizon));
    }
    if (s + step >= horizon) return horizon;
    if (s + step == s) break;
    s += step;
  }
  return s;
}

}  // namespace rbs

// Bounds for conservative advancement: B. Mirtich, "Impulse-based dynamic simulation of rigid body systems",
// PhD thesis, Berkeley, 1996. Two lower bounds of the separation along a direction n(s) are used.
//
// 1. Of the swept bodies, for a fixed n: a spinning body never leaves the solid of revolution about its spin,
//    so only the centres move, and n.p(s) is a parabola.
//
// 2. Of second order, for a direction that turns with an angular velocity w_n, n(s) = exp(w_n s) n. For a
//    point r of body X, seen from its centre, u(s) = n(s).r(s) has
//      u'(0) = r.m  with  m = n x (w_X - w_n),      |u''| <= k |r|,
//      k = 0 if w_n = w_X,  |w_X| |w_X x n| if w_n = 0,  (|w_X| + |w_n|)² else,
//    so with x = p_B - p_A and h_X(d) = max over X of d.r
//      separation(s) >= n(s).x(s) - h_A(n + s m_A) - h_B(-(n + s m_B)) - k s²/2.
//    It agrees with the motion to first order, so that advancing by it converges like Newton's method where
//    n turns with the face that is met. The bound is concave: its chords lie below it, its tangents above.
#include "narrowphase/safe_step.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

bool isPlane(const Mover& x) {
  return std::holds_alternative<Plane>(x.shape);
}

// The spin as far as it moves the surface.
Vec3 spin(const Mover& x) {
  return std::holds_alternative<Sphere>(x.shape) ? Vec3(Vec3::Zero()) : x.w_W;
}

double radiusOf(const Mover& x) {
  return isPlane(x) ? 0.0 : boundingRadius(x.shape);
}

// How far a body reaches along d, and how that grows with s when d is n + s m. A sphere's reach does not
// depend on the direction, and a plane is only asked for its normal.
struct Reach {
  double value = 0.0, slope = 0.0;
};

Reach reachAlong(const Mover& x, const Vec3& d, const Vec3& m) {
  if (const auto* sphere = std::get_if<Sphere>(&x.shape)) return {sphere->radius, 0.0};
  if (isPlane(x)) return {};
  const Vec3 farthest_W = x.R_WB * supportPoint(x.shape, x.R_WB.transpose() * d);
  return {farthest_W.dot(d), farthest_W.dot(m)};
}

// The reach along n of the solid that the body sweeps as it spins.
double sweptReach(const Mover& x, const Vec3& n) {
  const auto* box = std::get_if<Box>(&x.shape);
  const double rate = x.w_W.norm();
  const bool turns = rate > 0.0 && !isPlane(x) && !std::holds_alternative<Sphere>(x.shape);
  if (!turns) return reachAlong(x, n, Vec3::Zero()).value;
  if (box == nullptr) return boundingRadius(x.shape);
  const Vec3 axis_B = x.R_WB.transpose() * (x.w_W / rate);
  const double along = n.dot(x.w_W) / rate;
  const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
  double reach = 0.0;
  for (int corner = 0; corner < 4; ++corner) {  // and their opposites, by the sign of `along`
    const Vec3 r = 0.5 * box->size.cwiseProduct(Vec3(1.0, corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0));
    reach = std::max(reach, std::abs(along * axis_B.dot(r)) + across * axis_B.cross(r).norm());
  }
  return reach;
}

double curvature(const Vec3& w_X, const Vec3& w_n, const Vec3& n) {
  if (w_X == w_n) return 0.0;
  if (w_n.isZero(0.0)) return w_X.norm() * w_X.cross(n).norm();
  const double sum = w_X.norm() + w_n.norm();
  return sum * sum;
}

// The bound of second order.
class ConcaveBound {
 public:
  ConcaveBound(const Mover& a, const Mover& b, const Vec3& n, const Vec3& w_n, double separation,
               double horizon)
      : a_(a), b_(b), n_(n), m_a_(n.cross(spin(a) - w_n)), m_b_(n.cross(spin(b) - w_n)) {
    const Vec3 x = b.p_W - a.p_W, v = b.v_W - a.v_W, acceleration = b.a_W - a.a_W;
    const double loss = curvature(spin(a), w_n, n) * radiusOf(a) + curvature(spin(b), w_n, n) * radiusOf(b);
    double bend = n.dot(acceleration);
    if (const double turn = w_n.norm(); turn > 0.0) {
      // (n.x)'' = n''.x + 2 n'.x' + n.x'', with the largest |x| and |x'| up to the horizon.
      const double rush = horizon * acceleration.norm();
      const double speed = v.norm() + rush, distance = x.norm() + horizon * speed;
      bend = -(turn * turn * distance + 2.0 * turn * speed + acceleration.norm());
    }
    bend_ = std::min(bend - loss, 0.0);
    slope_ = n.dot(v) + w_n.cross(n).dot(x);
    offset_ = separation + reachAlong(a, n, m_a_).value + reachAlong(b, -n, -m_b_).value;
  }

  // Value and slope at s.
  Reach at(double s) const {
    const Reach reach_a = reachAlong(a_, n_ + s * m_a_, m_a_);
    const Reach reach_b = reachAlong(b_, -(n_ + s * m_b_), -m_b_);
    return {offset_ + s * (slope_ + 0.5 * s * bend_) - reach_a.value - reach_b.value,
            slope_ + s * bend_ - reach_a.slope - reach_b.slope};
  }

  // A time, at most `horizon`, up to which the bound stays at or above `floor`: between the root of a
  // chord, which is early, and that of a tangent, which is late, until they nearly agree.
  double timeAbove(double floor, double horizon) const {
    constexpr double kAgreed = 1e-4;
    double early = 0.0, late = horizon;
    double above = at(early).value - floor;
    if (!(above > 0.0)) return 0.0;
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
  const Mover &a_, &b_;
  Vec3 n_, m_a_, m_b_;
  double offset_, slope_, bend_;
};

// The bound of the swept bodies.
double sweptTime(const Mover& a, const Mover& b, const Vec3& n, double slack, double horizon) {
  const double gap = n.dot(b.p_W - a.p_W) - sweptReach(a, n) - sweptReach(b, -n) + slack;
  if (!(gap > 0.0)) return 0.0;
  return std::min(horizon, firstFall(gap, n.dot(b.v_W - a.v_W), n.dot(b.a_W - a.a_W)).value_or(horizon));
}

}  // namespace

// Of the two forms of each root, the one that adds numbers of equal sign.
std::optional<double> firstFall(double q0, double q1, double q2) {
  const double discriminant = q1 * q1 - 2.0 * q0 * q2;
  if (discriminant < 0.0) return std::nullopt;
  if (q1 < 0.0) return 2.0 * q0 / (std::sqrt(discriminant) - q1);
  if (q2 < 0.0) return (std::sqrt(discriminant) + q1) / -q2;
  return std::nullopt;
}

double safeStep(const Mover& a, const Mover& b, const Vec3& n_W, double separation, double slack,
                double horizon) {
  const auto timeAlong = [&](const Vec3& w_n, double limit) {
    return ConcaveBound(a, b, n_W, w_n, separation, limit).timeAbove(-slack, limit);
  };
  if (isPlane(a) || isPlane(b)) {
    const Vec3 w_plane = isPlane(a) ? a.w_W : b.w_W;
    const double step = timeAlong(w_plane, horizon);
    return w_plane.isZero(0.0) ? std::max(step, sweptTime(a, b, n_W, slack, horizon)) : step;
  }
  double step = std::max(timeAlong(Vec3::Zero(), horizon), sweptTime(a, b, n_W, slack, horizon));
  for (const Vec3& w_n : {spin(a), spin(b)}) {
    const double limit = std::min(horizon, 8.0 * step);
    if (step < horizon && !w_n.isZero(0.0)) step = std::max(step, timeAlong(w_n, limit));
  }
  return step;
}

}  // namespace rbs

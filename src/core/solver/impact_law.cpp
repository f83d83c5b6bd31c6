// SPDX-License-Identifier: BSD-3-Clause
#include "solver/impact_law.h"

#include "base/algebra.h"
#include "base/bracket.h"
#include "coulomb/cone.h"
#include "coulomb/coulomb.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs {

namespace {

// Energy, as a share of that of the closing, that the rounding of an impact may add; and the most solves that
// a smaller restitution is looked for with.
constexpr double kRoundedGain = 1e-12;
constexpr int kMostSolves = 60;

struct ImpactPoint {
  Vec3 r_a, r_b;                // from the centres
  Mat3 m_a, m_b;                // momentsOf() there
  Mat3 W;                       // response in the contact frame, 1/kg
  double closing_in;            // normal velocity before the impact, m/s; negative when closing
  Vec3 velocity_in;             // in the contact frame
  Vec3 impulse = Vec3::Zero();  // in the contact frame
};

// The impulse is in the contact frame.
void push(ImpactSide& side, const Mat3& frame, const Mat3& moments, const Vec3& impulse) {
  side.twist.v_WB += side.inv_mass * (frame * impulse);
  side.twist.w_WB += side.inv_inertia_W * (moments * impulse);
}

// In the contact frame. As a sum of squares it stays positive where r is long and along the normal.
Mat3 response(const ImpactSide& side, const Mat3& moments) {
  return side.inv_mass * Mat3::Identity() + moments.transpose() * side.inv_inertia_W * moments;
}

// In the contact frame.
Vec3 velocityOf(const ImpactSide& side, const Mat3& frame, const Mat3& moments) {
  return frame.transpose() * side.twist.v_WB + moments.transpose() * side.twist.w_WB;
}

// The axis about which the normal impulse has no moment on a side. An axis counts where impulses move that side alone.
Vec3 axisOf(const ImpactSide& side, const ImpactSide& other) {
  return side.inv_mass > 0.0 && other.inv_mass == 0.0 ? side.axis_W : Vec3(Vec3::Zero());
}

// The points of one impact, solved for a given e by block Gauss-Seidel with an exact solve a point. A single
// point needs one pass; the many points of a face converge linearly, and where that takes too long the
// solvers of whole islands take over. Convergence is asked of the velocities: the impulses of more than three
// points are not unique, and where the points do not quite lie in a plane they drift on without an effect. These solvers
// take every impact in which something resists turning.
class Impact {
 public:
  Impact(const ImpactSide& a, const ImpactSide& b, const Manifold& manifold, const ImpactLaw& law)
      : a_(a), b_(b), law_(law), size_(manifold.size) {
    const auto [t1, t2] = tangents(manifold.n_W);
    frame_ << t1, t2, manifold.n_W;
    for (int k = 0; k < size_; ++k) {
      ImpactPoint& c = points_[k];
      c.r_a = manifold.points[k].p_W - a.p_WB;
      c.r_b = manifold.points[k].p_W - b.p_WB;
      c.m_a = momentsOf(c.r_a, frame_, axisOf(a, b));
      c.m_b = momentsOf(c.r_b, frame_, axisOf(b, a));
      c.W = response(a, c.m_a) + response(b, c.m_b);
      c.velocity_in = relative(a, b, c);
      c.closing_in = c.velocity_in[2];
    }
  }

  // Returns the energy gained, as seen from either body: sum of r.(u_before + u_after)/2, J.
  double solve(double e, ImpactSide& a, ImpactSide& b) {
    a = a_, b = b_;
    for (int k = 0; k < size_; ++k) points_[k].impulse.setZero();
    constexpr int kMaxPasses = 30;
    constexpr double kConverged = 1e-14;  // share of the speeds
    bool still = false;
    for (int pass = 0; pass < kMaxPasses && !still && !resistsTurning(); ++pass) {
      const Twist a_before = a.twist, b_before = b.twist;
      for (int k = 0; k < size_; ++k) {
        ImpactPoint& c = points_[k];
        Vec3 q = relative(a, b, c) - c.W * c.impulse;
        q[2] += e * std::min(c.closing_in, 0.0);
        const Vec3 impulse = solveContact(c.W, q, law_.friction);
        push(a, frame_, c.m_a, c.impulse - impulse);
        push(b, frame_, c.m_b, impulse - c.impulse);
        c.impulse = impulse;
      }
      still = size_ == 1 || isStill(a_before, a, b_before, b, kConverged);
    }
    if (!still) solveTogether(e, a, b);
    double gain = 0.0;
    for (int k = 0; k < size_; ++k)
      gain += 0.5 * points_[k].impulse.dot(points_[k].velocity_in + relative(a, b, points_[k]));
    if (resistsTurning()) gain += 0.5 * torque_.dot(turning(a_, b_) + turning(a, b));
    return gain;
  }

  // On b, of the last solve.
  std::array<Vec3, Manifold::kPoints> impulses_W() const {
    std::array<Vec3, Manifold::kPoints> impulses;
    for (int k = 0; k < size_; ++k) impulses[k] = frame_ * points_[k].impulse;
    return impulses;
  }

 private:
  bool resistsTurning() const { return law_.radius > 0.0 && (law_.roll > 0.0 || law_.spin > 0.0); }

  // R times the angular velocity of b against a, in the contact frame, m/s.
  Vec3 turning(const ImpactSide& a, const ImpactSide& b) const {
    return law_.radius * (frame_.transpose() * (b.twist.w_WB - a.twist.w_WB));
  }

  // As one Coulomb problem of two bodies.
  void solveTogether(double e, ImpactSide& a, ImpactSide& b) {
    CoulombProblem problem{{}, {}, closingSpeedIn()};
    const auto add = [&](const ImpactSide& side) {
      if (side.inv_mass == 0.0) return kNone;
      const bool turns = !side.inv_inertia_W.isZero(0.0);
      problem.bodies.push_back({1.0 / side.inv_mass,
                                turns ? side.inv_inertia_W.inverse().eval() : Mat3::Identity().eval(),
                                side.twist.v_WB, side.twist.w_WB, turns});
      return static_cast<Index>(problem.bodies.size() - 1);
    };
    const Index i = add(a_), j = add(b_);
    for (int k = 0; k < size_; ++k) {
      const ImpactPoint& c = points_[k];
      CoulombPoint point;
      point.i = i, point.j = j;
      point.r_i = c.r_a, point.r_j = c.r_b;
      point.frame = frame_;
      point.axis_W = i == kNone ? axisOf(b_, a_) : axisOf(a_, b_);
      point.mu = law_.friction;
      Vec3 prescribed_W = Vec3::Zero();
      if (j == kNone) prescribed_W += velocityAt(b_.twist, c.r_b);
      if (i == kNone) prescribed_W -= velocityAt(a_.twist, c.r_a);
      point.bias = frame_.transpose() * prescribed_W;
      point.bias[2] += e * std::min(c.closing_in, 0.0);
      problem.points.push_back(point);
    }
    if (resistsTurning()) {
      TorqueConstraint torque;
      torque.i = i, torque.j = j;
      torque.first = 0, torque.size = static_cast<Index>(size_);
      torque.frame = frame_;
      torque.radius = law_.radius, torque.roll = law_.roll, torque.spin = law_.spin;
      Vec3 prescribed_W = Vec3::Zero();
      if (j == kNone) prescribed_W += b_.twist.w_WB;
      if (i == kNone) prescribed_W -= a_.twist.w_WB;
      torque.bias = law_.radius * (frame_.transpose() * prescribed_W);
      problem.torques.push_back(torque);
    }
    solveCoulomb(problem, 1e-12);
    a = a_, b = b_;
    if (i != kNone) a.twist = {problem.bodies[i].v, problem.bodies[i].w};
    if (j != kNone) b.twist = {problem.bodies[j].v, problem.bodies[j].w};
    for (int k = 0; k < size_; ++k) points_[k].impulse = problem.points[k].impulse;
    if (resistsTurning()) torque_ = problem.torques.front().impulse;
  }

  double closingSpeedIn() const {
    double fastest = 0.0;
    for (int k = 0; k < size_; ++k) fastest = std::max(fastest, -points_[k].closing_in);
    return fastest;
  }

  Vec3 relative(const ImpactSide& a, const ImpactSide& b, const ImpactPoint& c) const {
    return velocityOf(b, frame_, c.m_b) - velocityOf(a, frame_, c.m_a);
  }

  // Whether no point has changed its velocity by more than this share of those it is the difference of.
  bool isStill(const Twist& a_before, const ImpactSide& a, const Twist& b_before, const ImpactSide& b,
               double share) const {
    const Twist da{a.twist.v_WB - a_before.v_WB, a.twist.w_WB - a_before.w_WB};
    const Twist db{b.twist.v_WB - b_before.v_WB, b.twist.w_WB - b_before.w_WB};
    for (int k = 0; k < size_; ++k) {
      const ImpactPoint& c = points_[k];
      const Vec3 change = db.v_WB + db.w_WB.cross(c.r_b) - da.v_WB - da.w_WB.cross(c.r_a);
      if (change.norm() > share * (velocityAt(a_.twist, c.r_a).norm() + velocityAt(b_.twist, c.r_b).norm()))
        return false;
    }
    return true;
  }

  const ImpactSide a_, b_;
  const ImpactLaw law_;
  int size_;
  Mat3 frame_;
  Vec3 torque_ = Vec3::Zero();  // over R, on b, in the contact frame, N s
  std::array<ImpactPoint, Manifold::kPoints> points_;
};

}  // namespace

double closingSpeed(const ImpactSide& a, const ImpactSide& b, const Manifold& manifold) {
  double fastest = 0.0;
  const auto speedOf = [&](const ImpactSide& side, const ImpactSide& other, const Vec3& p_W) {
    const Vec3 r_W = p_W - side.p_WB, axis_W = axisOf(side, other);
    return manifold.n_W.dot(velocityAt(side.twist, r_W)) -
           momentAbout(axis_W, r_W, manifold.n_W) * axis_W.dot(side.twist.w_WB);
  };
  for (int k = 0; k < manifold.size; ++k) {
    const Vec3& p_W = manifold.points[k].p_W;
    const double u_n = speedOf(b, a, p_W) - speedOf(a, b, p_W);
    fastest = std::max(fastest, -u_n);
  }
  return fastest;
}

std::array<Vec3, Manifold::kPoints> collideBodies(ImpactSide& a, ImpactSide& b, const Manifold& manifold,
                                                  const ImpactLaw& law) {
  Impact impact(a, b, manifold, law);
  const double speed = closingSpeed(a, b, manifold);
  const double mass = 1.0 / (a.inv_mass + b.inv_mass);
  const double rounding = kRoundedGain * mass * speed * speed;
  const double gain = impact.solve(law.restitution, a, b);
  if (gain <= rounding) return impact.impulses_W();
  // The root of gain(e): the largest restitution found that adds nothing.
  double at_low = impact.solve(0.0, a, b);
  Bracket root(0.0, at_low, law.restitution, gain);
  for (int k = 0; k < kMostSolves && at_low < 0.0 && root.width() > kRoundedGain; ++k) {
    const double e = std::clamp(root.guess(), root.low(), root.high());
    const double at_e = impact.solve(e, a, b);
    root.narrow(e, at_e);
    if (at_e <= 0.0) at_low = at_e;
    if (at_e <= 0.0 && at_e >= -rounding) break;
  }
  impact.solve(root.low(), a, b);
  return impact.impulses_W();
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Where a segment ends early: at a point whose sliding stops, or a pair that stops turning.
#include "solver/exact_stepper.h"

#include <algorithm>
#include <cmath>

namespace rbs::exact_step {

namespace {

// In a heap that comes to rest a point may stop and slide again without end. It cuts a step no more often
// than this.
constexpr int kMostStops = 2;

}  // namespace

// What a torque constraint resists of how its pair turns; zero where it does not turn, or nothing resists.
Vec3 Stepper::turningOf(const CoulombBodies& bodies, const TorqueConstraint& torque) const {
  Vec3 u = turningAt(bodies, torque);
  if (torque.roll == 0.0 || u.head<2>().norm() <= slow_) u.head<2>().setZero();
  if (torque.spin == 0.0 || std::abs(u[2]) <= slow_) u[2] = 0.0;
  return u;
}

Stepper::Slip Stepper::slipNow() const {
  const CoulombBodies now = island_.bodies();
  Slip slip{std::vector<Vec2>(touching_.points.size(), Vec2::Zero()), {}};
  for (const TouchingTorque& torque : touching_.torques) {
    bool closed = false;
    for (Index k = torque.law.first; k < torque.law.first + torque.law.size; ++k)
      closed = closed || touching_.points[k].gap <= kTouch * touching_.points[k].length;
    slip.torques.push_back(closed ? turningOf(now, torque.law) : Vec3(Vec3::Zero()));
  }
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    if (touching_.law[k].mu == 0.0 || point.gap > kTouch * point.length) continue;
    const Vec2 u_T = velocityAt(now, touching_.law[k]).head<2>();
    if (u_T.norm() > slow_) slip.points[k] = u_T;
  }
  return slip;
}

Stepper::Left Stepper::slipLeft(const Slip& slip, const Touching& later, const CoulombBodies& bodies,
                                Friction friction) const {
  Left least;
  const auto keeps = [&](const Vec3& left_W, const Vec3& before_W, const Stop& of) {
    const double share = left_W.dot(before_W) / before_W.squaredNorm();
    if (share < least.share && std::count(stops_.begin(), stops_.end(), of) < kMostStops)
      least = {share, before_W.norm(), of};
  };
  for (std::size_t k = 0; k < slip.torques.size(); ++k) {
    const Index m = later.matching(touching_.torques[k]);
    if (m == kNone || later.torques[m].force_W.isZero(0.0)) continue;
    const Vec3 u = turningAt(bodies, later.torques[m].law), left_W = later.torques[m].law.frame * u;
    const Mat3& frame = touching_.torques[k].law.frame;
    const bool free = friction == Friction::Free;
    if (!slip.torques[k].head<2>().isZero(0.0) && !(free && u.head<2>().norm() > slow_))
      keeps(left_W, frame.leftCols<2>() * slip.torques[k].head<2>(), {touching_.torques[k].contact, {}});
    if (slip.torques[k][2] != 0.0 && !(free && std::abs(u[2]) > slow_))
      keeps(left_W, frame.col(2) * slip.torques[k][2], {touching_.torques[k].contact, {}});
  }
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    if (slip.points[k].isZero(0.0)) continue;
    const Index m = later.matching(touching_.points[k]);
    if (m == kNone || later.points[m].force_W.isZero(0.0)) continue;
    const Vec3 u = velocityAt(bodies, later.law[m]);
    if (friction == Friction::Free && u.head<2>().norm() > slow_) continue;
    keeps(later.law[m].frame * u, touching_.law[k].frame.leftCols<2>() * slip.points[k],
          {touching_.points[k].contact, touching_.points[k].feature});
  }
  return least;
}

// Finds where the first sliding point stops, by the Illinois rule on its speed: a straight line under
// constant forces, so that two attempts are enough. The residual speed of a solve cannot be distinguished
// from rest.
void Stepper::cutAtStop(double& tau, Segment& segment) {
  const auto none = [&](const Left& left) {
    return std::abs(left.share) < 1e-13 ||
           std::abs(left.share) * left.speed < wanted_tolerance_ * island_.loadSpeed();
  };
  double low = 0.0, f_low = 1.0, high = tau,
         f_high = trySegment(tau, Friction::KeepsDirection).slip_left.share;
  if (f_high >= 0.0) return;
  for (int k = 0; k < 12 && high - low > 1e-14 * tau; ++k) {
    const double middle = (low * f_high - high * f_low) / (f_high - f_low);
    const Left left = trySegment(middle, Friction::KeepsDirection).slip_left;
    const double f = left.share;
    if (none(left)) {
      low = high = middle;
    } else if (f > 0.0) {
      low = middle, f_low = f, f_high *= 0.5;
    } else {
      high = middle, f_high = f, f_low *= 0.5;
    }
  }
  tau = high;
  segment = trySegment(tau, Friction::Free);
}

}  // namespace rbs::exact_step

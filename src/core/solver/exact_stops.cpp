// SPDX-License-Identifier: BSD-3-Clause
// Where a segment ends early: at a point whose sliding stops, a pair that stops turning, or a contact that comes off at once.
#include "solver/exact_stepper.h"

#include "base/bracket.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace rbs::exact_step {

namespace {

// In a heap that comes to rest a point may stop and slide again without end. It cuts a step no more often
// than this.
constexpr int kMostStops = 2;
// A speed that changes this many times as fast as over the whole segment does so in a jump: something else happens at that
// time, and none at which it is zero is found.
constexpr double kSteep = 20.0;
// A contact that keeps less than this share of its force may have come off within the segment. What a body bears that
// matters is more than this share of what its load would ask for.
constexpr double kKept = 0.9, kBorne = 0.01;
// The contact is on while it keeps this share of what it loses. A loss that differs from an even one by less than kEven at a
// half and a quarter of the segment is none of an instant.
constexpr double kOn = 0.97, kEven = 0.2;
// Halvings of the segment in which the loss is looked for; and the share of it that is as good as none.
constexpr int kLossHalvings = 12;
constexpr double kInstant = 1e-3;

// Whether some point of a torque constraint bears a force. What has stopped needs no torque, and has none.
bool isPressed(const TouchingPoints& touching, const TorqueConstraint& torque) {
  for (Index k = torque.first; k < torque.first + torque.size; ++k)
    if (!touching.points[k].force_W.isZero(0.0)) return true;
  return false;
}

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

Stepper::Left Stepper::slipLeft(const Slip& slip, const TouchingPoints& later, const CoulombBodies& bodies,
                                Friction friction) const {
  Left least;
  const auto keeps = [&](const Vec3& left_W, const Vec3& before_W, const Stop& of) {
    const double share = left_W.dot(before_W) / before_W.squaredNorm();
    if (share < least.share && std::count(stops_.begin(), stops_.end(), of) < kMostStops)
      least = {share, before_W.norm(), of};
  };
  for (std::size_t k = 0; k < slip.torques.size(); ++k) {
    const Index m = later.matching(touching_.torques[k]);
    if (m == kNone || !isPressed(later, later.torques[m].law)) continue;
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

// Finds where the first sliding point stops, by false position on its speed: a straight line under constant forces, so that two
// attempts are enough. The residual speed of a solve cannot be distinguished from rest.
void Stepper::cutAtStop(double& tau, Segment& segment) {
  const auto none = [&](const Left& left) {
    return std::abs(left.share) < 1e-13 ||
           std::abs(left.share) * left.speed < wanted_tolerance_ * island_.loadSpeed();
  };
  const double f_tau = trySegment(tau, Friction::KeepsDirection).slip_left.share;
  if (f_tau >= 0.0) return;
  Bracket stop(0.0, 1.0, tau, f_tau);
  double before = 1.0, after = f_tau, found = tau;
  const auto isJump = [&] { return (before - after) * tau > kSteep * (1.0 - f_tau) * stop.width(); };
  for (int k = 0; k < 12 && stop.width() > 1e-14 * tau && !isJump(); ++k) {
    const double middle = stop.guess();
    const Left left = trySegment(middle, Friction::KeepsDirection).slip_left;
    if (none(left)) {
      found = middle;
      break;
    }
    stop.narrow(middle, left.share);
    (left.share > 0.0 ? before : after) = left.share;
    found = stop.high();
  }
  tau = found;
  segment = trySegment(tau, Friction::Free);
}

// Normal force of a contact as the segment begins, as far as it is known, N.
double Stepper::pushAtStart(Index contact) const {
  double push = 0.0;
  for (std::size_t k = touching_.firstOf(contact);
       k < touching_.points.size() && touching_.points[k].contact == contact; ++k)
    push += std::max(touching_.law[k].frame.col(2).dot(touching_.points[k].force_W), 0.0);
  return push;
}

double Stepper::pushAtEnd(const Segment& segment, Index contact) const {
  const std::vector<TouchingPoint>& points = segment.touching.points;
  double push = 0.0;
  for (std::size_t k = segment.touching.firstOf(contact); k < points.size() && points[k].contact == contact;
       ++k)
    push += segment.push[k];
  return push;
}

// The contact that loses most of its force in a segment. Each is asked for once in an interval. Nothing is known of the force
// of a contact that is new in this step, but what a short segment says.
std::optional<Stepper::Loss> Stepper::lossIn(const Segment& segment, double tau) {
  std::optional<Segment> instant;
  const auto pushBefore = [&](Index contact) {
    const double known = pushAtStart(contact);
    if (known > 0.0 || !context_.scene.contacts.active[contact].points.empty()) return known;
    if (!instant) instant = trySegment(kInstant * tau, Friction::Free);
    return pushAtEnd(*instant, contact);
  };
  std::optional<Loss> found;
  double most = 0.0;
  for (std::size_t k = 0; k < touching_.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    const bool is_first = k == 0 || touching_.points[k - 1].contact != point.contact;
    if (!is_first || std::find(losses_.begin(), losses_.end(), point.contact) != losses_.end()) continue;
    if (pushAtStart(point.contact) == 0.0 && point.gap > kTouch * point.length) continue;
    double mass = std::numeric_limits<double>::infinity();
    for (const Index slot : {touching_.law[k].i, touching_.law[k].j})
      if (slot != kNone) mass = std::min(mass, island_.bodies()[slot].mass);
    const double after = pushAtEnd(segment, point.contact), load = mass * island_.loadSpeed() / step_.h();
    if (after > kKept * load && pushAtStart(point.contact) == 0.0) continue;
    const double before = pushBefore(point.contact), lost = before - after;
    if (before < kBorne * load || lost < (1.0 - kKept) * before) continue;
    if (lost > most) most = lost, found = Loss{point.contact, before};
  }
  return found;
}

// Finds where a contact comes off, by bisection: the longest segment at whose end it still bears its force. One that is a little
// too long ends with less: the first kick holds the body until it just touches what is no longer below it. A force that
// falls evenly comes to its end by itself, and such a segment stays as it is. The next segment begins with a contact that
// comes off in the first part of 2^-kLossHalvings of it.
bool Stepper::cutAtLoss(const Loss& loss, double& tau, Segment& segment) {
  const double after = pushAtEnd(segment, loss.contact);
  double low = 0.0, high = tau;
  bool is_even = true;
  std::optional<Segment> held;
  for (int k = 0; k < kLossHalvings && !budget_.isSpent(); ++k) {
    const double middle = 0.5 * (low + high);
    Segment trial = trySegment(middle, Friction::Free);
    const double kept = (pushAtEnd(trial, loss.contact) - after) / (loss.push - after);
    is_even = is_even && std::abs(kept - (1.0 - middle / tau)) < kEven;
    if (k == 1 && is_even) return false;
    if (kept > kOn) {
      low = middle, held = std::move(trial);
    } else {
      high = middle;
    }
  }
  if (!held) return false;
  tau = low;
  segment = std::move(*held);
  return true;
}

}  // namespace rbs::exact_step

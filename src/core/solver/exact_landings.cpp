// SPDX-License-Identifier: BSD-3-Clause
// Where a segment ends early: an open point comes down, and its velocity jumps.
//
// A block rocks from one edge onto the other; a prism rolls on. The first kick lets an open point come down just at the end of
// the segment. So it would brake the point on all its way, with an impulse that is not the one of the law, whenever it lands in
// between: an error of first order in the length of the segment. Therefore the segment is cut where the point lands: the bodies
// go their way without the points that the first kick would stop, and the time is sought at which the lowest of these has no
// gap. What has landed goes on until the next segment begins, which first makes the velocities obey the law: an impact without
// restitution of all points that touch, in no time, so that no load acts in it.
//
// Not all that the first kick stops comes down. It takes the gap that a point will have from how that closes now, and features
// pass each other: a corner of a box that slides in a drum of tiles closes on the far end of the next tile, and is on the other
// side of its edge when it gets there. Such a point is not there after the drift, and is let go. Where the drift without it ends in
// an overlap, that is at points which it has there (addUnforeseen()).
#include "solver/exact_stepper.h"

#include "base/bracket.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs::exact_step {

namespace {

// A point that closes by less than this share of what the load adds to a speed in a step comes down so gently that nothing
// depends on the time.
constexpr double kGentle = 0.05;
// Trials of the length of the segment. The gap falls in nearly a parabola, so that half as many are enough as a rule.
constexpr int kTrials = 12;
// A landing in this last part of a step is one at its end.
constexpr double kAtTheEnd = 1e-6;
// Share of the smaller length of a pair within which two points are at one place.
constexpr double kSamePlace = 0.01;

}  // namespace

// Whether a point after a drift has come down in it: it is one of those that are open, or at no place of a point of now. A corner
// has another feature on each face that it is looked at from, so places decide.
bool Stepper::comesDown(const TouchingPoint& point, const CoulombPoint& law, const Open& open,
                        const std::vector<BodyMotion>& start, const std::vector<BodyMotion>& end,
                        double tau) const {
  const auto isIt = [&](const TouchingPoint& other) {
    return other.contact == point.contact && other.feature == point.feature;
  };
  if (std::any_of(open.begin(), open.end(), isIt)) return true;
  const auto back = takenBack(point, law, start, end, tau);
  const Index known = touching_.matching(point);
  if (known != kNone && !isElsewhere(back, touching_.points[known])) return false;
  const auto isThere = [&](const TouchingPoint& other) {
    const double distance = std::min((back.first - other.p_W).norm(), (back.second - other.p_W).norm());
    return other.contact == point.contact && distance < kSamePlace * point.length;
  };
  return std::none_of(touching_.points.begin(), touching_.points.end(), isThere);
}

// What comes down first if the bodies go on for `tau`: of these points, and of those that the contacts come to have elsewhere.
Stepper::Landing Stepper::landingAfter(double tau, const Open& open) {
  const std::vector<BodyMotion> start = island_.save();
  const CoulombBodies at_start = island_.bodies();
  CoulombProblem kick = firstKick(slipNow(), tau, Friction::Free);
  Segment trial;
  solveAndDrift(kick, at_start, tau, trial);
  const CoulombBodies drifted = island_.bodies();
  const std::vector<BodyMotion> end = island_.save();
  island_.restore(start);
  Landing first;
  for (std::size_t k = 0; k < trial.touching.points.size(); ++k) {
    const TouchingPoint& point = trial.touching.points[k];
    const CoulombPoint& law = trial.touching.law[k];
    if (point.gap / point.length > first.share) continue;
    if (!comesDown(point, law, open, start, end, tau)) continue;
    const auto [p_i, p_j] = takenBack(point, law, start, end, tau);
    first = {point.gap / point.length, velocityAt(drifted, law)[2],
             law.frame.col(2).dot(p_j - p_i) / point.length};
  }
  return first;
}

// Lets go what the first kick has stopped for nothing. What has pushed before in this step stays, so that its impulse is not lost,
// and so does what would be on the other side of the contact without it.
void Stepper::letGo(double tau, Segment& segment) {
  while (cuts_ > 0 && !budget_.isSpent()) {
    std::vector<Index> stopped;
    for (const Index k : segment.landing) {
      const TouchingPoint& point = touching_.points[k];
      const Index m = segment.touching.matching(point);
      const bool is_there = m != kNone && segment.touching.points[m].gap <= kPushedGap * point.length;
      if (!is_there && point.impulse_W.isZero(0.0)) stopped.push_back(k);
    }
    if (stopped.empty()) return;
    cuts_ -= static_cast<int>(touching_.points.size());
    TouchingPoints rest = touching_.without(stopped);
    std::swap(rest, touching_);
    Segment free = trySegment(tau, Friction::Free);
    const auto passes = [&](Index k) {
      const std::size_t m = free.touching.firstOf(rest.points[k].contact);
      return m == free.touching.points.size() ||
             free.touching.law[m].frame.col(2).dot(rest.law[k].frame.col(2)) <= 0.0;
    };
    if (!free.first.converged || std::any_of(stopped.begin(), stopped.end(), passes)) {
      std::swap(rest, touching_);
      return;
    }
    segment = std::move(free);
  }
}

// Finds where the first of what lands does so, by false position on its gap, and cuts the segment there. False: nothing
// lands, or so gently that it need not be known when.
bool Stepper::cutAtLanding(double& tau, Segment& segment) {
  constexpr double kLanded = 0.5 * kTouch;
  TouchingPoints all = touching_.without(segment.landing);
  std::swap(all, touching_);
  Open open;
  double share_now = std::numeric_limits<double>::infinity();
  for (const Index k : segment.landing) {
    open.push_back(all.points[k]);
    share_now = std::min(share_now, open.back().gap / open.back().length);
  }
  const Landing whole = landingAfter(tau, open);
  if (open.empty()) share_now = whole.before;
  const bool lands =
      share_now > kLanded && whole.share < -kLanded && whole.speed < -kGentle * island_.loadSpeed();
  Bracket landing(0.0, share_now, tau, whole.share);
  double at = tau, share = whole.share;
  for (int k = 0; lands && k < kTrials && std::abs(share) > kLanded && hasRoomForLandings(); ++k) {
    at = landing.guess();
    share = std::min(landingAfter(at, open).share, share_now);
    landing.narrow(at, share);
  }
  // No segment would come after it to stop the point.
  const bool ends_with_it = end_ - now_ - at <= kAtTheEnd * step_.h();
  if (!lands || std::abs(share) > kLanded || ends_with_it) {
    std::swap(all, touching_);
    return false;
  }
  const std::vector<Index> landed = segment.landing;
  tau = at;
  segment = trySegment(tau, Friction::Free, &open);
  std::swap(all, touching_);
  // A point that lands again has pushed before in this step.
  for (const Index k : landed) {
    const TouchingPoint& point = touching_.points[k];
    const Index m = segment.touching.matching(point);
    if (point.impulse_W.isZero(0.0)) continue;
    if (m != kNone)
      segment.touching.points[m].impulse_W += point.impulse_W;
    else
      segment.opened.emplace_back(point.contact, openedPoint(point, touching_.law[k].frame.col(2)));
  }
  return true;
}

}  // namespace rbs::exact_step

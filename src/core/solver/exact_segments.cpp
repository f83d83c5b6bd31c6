// SPDX-License-Identifier: BSD-3-Clause
// How long a segment of the exact step is: what turns fast, sinks in or gains energy asks for short ones.
#include "solver/exact_stepper.h"

#include <algorithm>
#include <cmath>

namespace rbs::exact_step {

namespace {

// Sine of the tilt from which a body stands on its rim.
constexpr double kLeaning = 0.01;
// |w| tau of a body that is not a ball, that of a sub-step of the soft step where there is one, and the most segments of a
// step that it may ask for.
constexpr double kTurn = 0.2, kSoftTurn = 0.5;
constexpr int kMostSegments = 64;
// An overlap that grows by more than this share of the smaller length within a segment halves the segment, down to
// 2^-kMostHalvings of its length. Two segments in a row that are good double it again. The soft step leaves no less
// than kSoftSunk, and at the settings that have it nothing is gained by more.
constexpr double kMostSunk = 2e-5, kSoftSunk = 1e-3;
// So does a gain of energy beyond this share.
constexpr double kMostGained = 1e-4;
// Of the margin at which pairs are looked at: where to stop widening it.
constexpr double kFarthest = 256.0;
// Cuts at stops that the searches for the loss of a contact and for a landing count for.
constexpr int kLossWork = 10, kLandingWork = 3;

}  // namespace

// What comes round quickly asks for short segments. A disc that falls flat goes round the faster the flatter it is, so that
// one look at the start of the step would not do.
void Stepper::limitSegment() {
  const double left = end_ - now_;
  const int most = std::max(1, static_cast<int>(kMostSegments * (left / step_.h())));
  const double segments = std::ceil(turnsBy(left) / (promoted_ ? kSoftTurn : kTurn));
  longest_ = std::min(longest_, left / std::clamp(segments, 1.0, 1.0 * most));
}

// How far a body that is not a ball turns in some time at most, rad, or the point of a rim on which one stands goes round. That
// point lies where the axis a leans, so that it turns about the normal n as the part of a across n does, whose length is the
// sine of the tilt: with a' = w x a by n (a x a') / |a x n|^2 = n (w - (a w) a) / |a x n|^2.
double Stepper::turnsBy(double seconds) const {
  const Bodies& bodies = context_.scene.bodies;
  double rate = 0.0;
  for (const Index i : island_.indices())
    if (!bodies.traits[i].round) rate = std::max(rate, bodies.twist[i].w_WB.norm());
  for (std::size_t k = 0; k < touching_.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    if (point.force_W.isZero(0.0) && point.gap > kTouch * point.length) continue;
    const Contact& contact = context_.scene.contacts.active[point.contact];
    for (const Index i : {contact.i, contact.j}) {
      const Traits& traits = bodies.traits[i];
      if (!traits.revolved || traits.round || !traits.moved_by_forces()) continue;
      const Vec3 axis = bodies.pose[i].q_WB * Vec3::UnitZ();
      const Vec3 n_W = touching_.law[k].frame.col(2), w_WB = bodies.twist[i].w_WB;
      const double leans = axis.cross(n_W).squaredNorm();
      if (leans > kLeaning * kLeaning)
        rate = std::max(rate, std::abs(n_W.dot(w_WB - axis.dot(w_WB) * axis)) / leans);
    }
  }
  return rate * seconds;
}

// After two good segments in a row: what asked for short ones, an impact or a rim that came round, is over as a rule.
void Stepper::lengthen() {
  if (halvings_ == kMostHalvings || ++good_ < 2) return;
  good_ = 0;
  ++halvings_;
  longest_ *= 2.0;
}

// How long the next segment is to be, s.
double Stepper::nextLength() const {
  const double left = end_ - now_;
  return left > 1.5 * longest_ ? longest_ : left;
}

// The next segment. It is halved while bodies end deeper in each other than they began, and while it gains energy: where contacts
// run along round bodies faster than the corrections follow, they push too long or too hard.
void Stepper::findSegment() {
  const std::vector<BodyMotion> start = island_.save();
  const double deepest = deepestShare(touching_),
               kinematic_before = workByKinematic(touching_, opened_, now_);
  for (;; --halvings_) {
    tau_ = nextLength();
    segment_ = trySegment(tau_, Friction::Free);
    while (reach_ < kFarthest && tellsWay(segment_.first) && hasMissedContact(segment_.touching)) {
      widenMargin();
      segment_ = trySegment(tau_, Friction::Free);
    }
    const TouchingPoints foreseen = touching_;
    const std::size_t stops = stops_.size(), losses = losses_.size();
    const double uncut = tau_;
    const int points = static_cast<int>(touching_.points.size() + touching_.torques.size());
    letGo(tau_, segment_);
    const bool lands = locatesLandings() && (!segment_.landing.empty() || withUnforeseen(segment_, tau_));
    // In a group a trial costs more, and what one of its bodies does matters less to the others.
    const int landing_work = apart_ ? points : points * static_cast<int>(island_.indices().size());
    if (lands && cuts_ >= kLandingWork * landing_work && hasRoomForLandings()) {
      cuts_ -= landing_work;
      if (cutAtLanding(tau_, segment_)) cuts_ -= (kLandingWork - 1) * landing_work;
    }
    if (segment_.slip_left.share <= 1e-9 && cuts_ >= points && !budget_.isSpent()) {
      cuts_ -= points;
      stops_.push_back(segment_.slip_left.of);
      cutAtStop(tau_, segment_);
    }
    if (island_.indices().size() == 1 && cuts_ >= kLossWork * points && !budget_.isSpent())
      if (const std::optional<Loss> loss = lossIn(segment_, tau_)) {
        cuts_ -= points;
        losses_.push_back(loss->contact);
        if (cutAtLoss(*loss, tau_, segment_)) cuts_ -= (kLossWork - 1) * points;
      }
    addUnforeseen();
    const double most_sunk = promoted_ ? kSoftSunk : kMostSunk;
    const bool sunk = tellsWay(segment_.first) && deepestShare(segment_.touching) > deepest + most_sunk;
    const bool solved = segment_.first.converged && segment_.second.converged;
    const bool gains = solved && gainOf(start, kinematic_before) > kMostGained;
    if (!(sunk || gains)) return lengthen();
    good_ = 0;
    if (halvings_ == 0 || budget_.isSpent()) return;
    touching_ = foreseen;
    stops_.resize(stops);
    losses_.resize(losses);
    longest_ = 0.5 * uncut;
  }
}

}  // namespace rbs::exact_step

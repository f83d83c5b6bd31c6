// SPDX-License-Identifier: BSD-3-Clause
// Contacts: what is known of two bodies while their bounds overlap.
//
// The broad phase makes a contact when the bounds of two bodies begin to overlap, and drops it when they no
// longer do. Between the two it persists. A solver starts from the points that the last solve left, and
// leaves its own: their forces warm-start the next step, their impulses are reported.
#pragma once

#include "narrowphase/separating_axis.h"
#include "state/bodies.h"
#include "state/pair_state.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

namespace rbs {

/// One point of a contact at the end of its last solve.
struct SolvedPoint {
  /// Features that no pair of shapes has. kNoSide: the bodies share a centre, so that the normal says nothing.
  /// kLifted: the impulse by which a plane stopped a body. kPassed: the point was elsewhere on the bodies before.
  static constexpr std::uint32_t kNoSide = 0xffffffff, kLifted = 0xfffffffe, kPassed = 0xfffffffd;

  std::uint32_t feature = 0;               ///< finds the same point again in the next step
  double normal = 0.0;                     ///< force along n_W, N, >= 0: the warm start for the next solve
  Vec3 friction_W = Vec3::Zero();          ///< force across n_W on body j, N: a warm start as well
  Vec3 p_W = Vec3::Zero();                 ///< m
  Vec3 n_W = Vec3::UnitZ();                ///< unit, from i to j
  double separation = 0.0;                 ///< along n_W, m; negative is penetration
  double normal_impulse = 0.0;             ///< over the part of the step that was solved last, N s
  Vec3 friction_impulse_W = Vec3::Zero();  ///< on body j, over the same part, N s

  /// Takes an impulse on body j, N s, for its parts along n_W and across it.
  void setImpulse(const Vec3& impulse_W) {
    normal_impulse = impulse_W.dot(n_W);
    friction_impulse_W = impulse_W - normal_impulse * n_W;
  }
  /// Adds the impulse that the same point gave earlier in the step, when its normal may have been another:
  /// the sum of the whole impulses stays normal_impulse n_W + friction_impulse_W.
  void addImpulseOf(const SolvedPoint& earlier) {
    normal_impulse += earlier.normal_impulse;
    friction_impulse_W += earlier.friction_impulse_W + earlier.normal_impulse * (earlier.n_W - n_W);
  }
};

/// What the points that a contact had last say of its normal.
struct LastNormal {
  Vec3 n_W = Vec3::Zero();  ///< unit, from i to j; zero: no point bore a force or overlapped
  bool loaded = false;      ///< one bore a force
};

/// Two bodies, and the part of each that touches: i was created before j. Keys sort in canonical order.
struct ContactKey {
  BodyId i, j;
  std::uint32_t child_i = 0, child_j = 0;  ///< parts of a compound body; 0: its only shape

  friend bool operator==(const ContactKey& a, const ContactKey& b) { return a.tied() == b.tied(); }
  friend bool operator<(const ContactKey& a, const ContactKey& b) { return a.tied() < b.tied(); }
  std::tuple<BodyId, BodyId, std::uint32_t, std::uint32_t> tied() const { return {i, j, child_i, child_j}; }
};

struct Contact {
  ContactKey key;
  Index i = kNone, j = kNone;  ///< dense indices of the bodies, valid for the step
  PairState state;
  bool exact = false;               ///< the exact step solved its points
  bool solved = false;              ///< its points are of this step; false: of the last one
  std::vector<SolvedPoint> points;  ///< as the last solve left them
  /// Once it has been solved in this step: what `points` and `exact` were when the step began.
  std::vector<SolvedPoint> points_before;
  bool exact_before = false, has_before = false;
  /// Impulses given earlier in this step of the World and no longer in `points`: of located impacts, of divisions before
  /// this one, and of points that have opened. One for each point, as it was last; by feature.
  std::vector<SolvedPoint> earlier;
  /// The step of the World, counted from 1, in which the two began to touch; 0: they do not.
  std::uint64_t touching_from = 0;
  /// Of its last query, with the counts of the step. It changes no result, only the time that one takes.
  mutable SeparatingAxis axis;

  /// The bodies may touch in this step and have not yet.
  bool isFresh() const { return state.isCandidate() && earlier.empty(); }
  bool isOf(BodyId body) const { return key.i == body || key.j == body; }
  /// Whether one of its points bears a force.
  bool bears() const {
    return std::any_of(points.begin(), points.end(),
                       [](const SolvedPoint& point) { return point.normal > 0.0; });
  }
  /// Whether a point has given a normal impulse of more than `least`, N s, in this step of the World.
  bool pushed(double least) const {
    const auto pushes = [&](const SolvedPoint& point) { return point.normal_impulse > least; };
    return std::any_of(points.begin(), points.end(), pushes) ||
           std::any_of(earlier.begin(), earlier.end(), pushes);
  }
  /// ContactPoint::touching_steps after `steps` steps of the World.
  std::uint64_t touchingSteps(std::uint64_t steps) const {
    return touching_from == 0 ? 0 : steps - touching_from + 1;
  }
  /// The point of a feature, as the last solve left it; null when there is none.
  const SolvedPoint* pointOf(std::uint32_t feature) const {
    for (const SolvedPoint& point : points)
      if (point.feature == feature) return &point;
    return nullptr;
  }
  /// What its points say of its normal; forces count that are larger than `least`, N.
  LastNormal lastNormal(double least) const {
    LastNormal last;
    for (const SolvedPoint& point : points) {
      if (!last.loaded && point.normal > least) last = {point.n_W, true};
      if (last.n_W.isZero(0.0) && point.separation < 0.0 && point.feature != SolvedPoint::kNoSide)
        last.n_W = point.n_W;
    }
    return last;
  }
  /// Largest penetration depth of its points, m; 0 where none overlaps.
  double depth() const {
    double depth = 0.0;
    for (const SolvedPoint& point : points) depth = std::max(depth, -point.separation);
    return depth;
  }
  /// Adds to `earlier` the impulse of one point.
  void addEarlier(const SolvedPoint& point);
  /// Adds to `earlier` the impulses of all points.
  void addEarlier();
  /// Makes room for the points of another solve. Impulses given in this step are kept.
  void beginSolve();
  /// Takes back all solves of the step, but not the impulses that are in `earlier`.
  void takeBackSolves();
  /// Drops all that is known: a body has been moved or reshaped.
  void forget() { points.clear(), earlier.clear(), exact = false, axis = {}, touching_from = 0; }
};

/// The contacts of a scene.
struct Contacts {
  /// Pairs whose bounds overlap in this step, by key; those that impacts have added in the step stand behind
  /// the others until its end.
  std::vector<Contact> active;
  /// Pairs that no stage looks at, by key: those that are asleep, and those whose bounds overlap no more but
  /// which have given impulses in this step of the World.
  std::vector<Contact> dormant;

  /// Takes over the pairs of the broad phase, i before j and sorted. A pair that is known keeps its points.
  /// Of those not found the ones that `rests` stay, and those with impulses of this step.
  void update(const Bodies& bodies, const IndexPairs& found,
              const std::function<bool(const Contact&)>& rests);
  /// The contact of a pair that is not among the active ones: the dormant one, made where there is none.
  Contact& dormantOf(const Bodies& bodies, Index i, Index j);
  /// Adds a pair to the active contacts, with what is known of it, and gives its place.
  Index add(const Bodies& bodies, Index i, Index j);
  /// Sorts the active contacts: what add() has appended goes to its place. Costs little where that is nothing.
  void sortActive();
  /// At the end of a step: sorts the contacts, and drops points that were not solved in it, but for those that `rests`.
  void endStep(const std::function<bool(const Contact&)>& rests);
  /// The place of a pair among the active contacts, the first `sorted` of which are sorted; kNone when it is
  /// not there.
  Index find(Index i, Index j, std::size_t sorted) const;
  /// All that have points or impulses, by key.
  std::vector<const Contact*> withPoints() const;
  void forget(BodyId body);
  void remove(BodyId body);
  /// Begins a step of the World: no impulses have been given in it, and pairs without points have come apart.
  void beginWorldStep();
  /// Ends step number `step` of the World, counted from 1, of `seconds`: tells which pairs touch, and since when. They do where
  /// the impulse of a point changes the lighter body's velocity by more than `least`, m/s.
  void endWorldStep(const Bodies& bodies, std::uint64_t step, double seconds, double least);

 private:
  std::vector<Contact> last_active_, last_dormant_;  // while they are updated
};

/// A contact of two bodies, i before j, of which nothing is known.
Contact newContact(const Bodies& bodies, Index i, Index j);

/// Points, each with the place of its contact.
using PointsOfContacts = std::vector<std::pair<Index, SolvedPoint>>;

}  // namespace rbs

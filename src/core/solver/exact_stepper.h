// SPDX-License-Identifier: BSD-3-Clause
// One island on its way through the exact step. The scheme is in exact_step.cpp, with the segments that make
// up the way; the files beside it have what stands below under their names.
#pragma once

#include "base/tolerances.h"
#include "coulomb/coulomb.h"
#include "solver/inner_step.h"
#include "solver/island_motion.h"
#include "solver/methods.h"
#include "solver/touching_points.h"

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace rbs::exact_step {

using Vec2 = Eigen::Vector2d;

/// The force to expect of a point when `share` of what was found beyond the one expected lasts; the one
/// expected to the last bit for none.
inline Vec3 expectedNext(const Vec3& expected_W, const Vec3& found_W, double share) {
  if (share == 0.0) return expected_W;
  return share == 1.0 ? found_W : Vec3(expected_W + share * (found_W - expected_W));
}

/// Whether a force or impulse in a contact frame is less than friction may be: its point sticks.
inline bool isWithinCone(const Vec3& force, double mu) {
  return force.head<2>().norm() < mu * force[2] * (1.0 - 1e-6);
}

/// Share of the smaller length of a pair up to which a pushed point is taken for closed: more than the
/// curvature of a drift leaves.
inline constexpr double kPushedGap = 1e-3;
/// The least that is asked of a solve, however short the drift or small the overlap that it is about.
inline constexpr double kCoarsest = 1e-6;

/// Whether an answer tells where bodies go: it has converged, or not quite.
inline bool tellsWay(const CoulombResult& result) {
  return result.converged || std::max({result.signorini, result.coulomb, result.dissipation}) <= kCoarsest;
}

class Stepper : public InnerRows {
 public:
  /// @param ends_early where the budget is out in the last segment, its solves end with the best they have; false:
  ///   OverBudget
  Stepper(Context& context, const Subgraph& batch, double t0, double t1, SolveBudget& budget, bool ends_early,
          InnerClock& clock);

  void collide();
  void prepare();
  bool beginSubStep();
  void solve();
  void integrate();
  void store();
  /// NoSolution and OverBudget leave the island as it was.
  Outcome outcome() const { return outcome_; }
  bool isGoing() const { return outcome_ == Outcome::Done || outcome_ == Outcome::NoRoom; }

 private:
  static constexpr int kMostHalvings = 8;  // of a segment

  // How fast closed points slide, and the pairs of torque constraints turn, in their frames; zero where they do not.
  struct Slip {
    std::vector<Vec2> points;
    std::vector<Vec3> torques;
  };
  // What may stop: the sliding of a point, or the turning of a pair.
  using Stop = std::pair<Index, std::optional<std::uint32_t>>;  // contact; feature of the point
  // What a segment has left of the sliding, or turning, that has lost the most of its speed.
  struct Left {
    double share = 1.0;  // <= 0: it has stopped
    double speed = 0.0;  // before the segment, m/s
    Stop of{};
  };
  // How a segment ends.
  struct Segment {
    std::vector<BodyMotion> end;
    TouchingPoints touching;
    PointsOfContacts opened;      // in between
    std::vector<Index> landing;   // points that were open at its start and that its first kick stops
    CoulombResult first, second;  // of its kicks
    std::vector<double> push;     // by point of its end: the normal force there, N
    Left slip_left;
    double squeezing = 0.0;  // at its end: see squeezingOf()
  };
  // A contact that loses most of its force in a segment.
  struct Loss {
    Index contact;
    double push;  // normal force before, N
  };
  // A point that comes down at the end of a segment.
  struct Landing {
    double share =
        std::numeric_limits<double>::infinity();  // of its gap in the smaller length; infinite: there is none
    double speed = 0.0;                           // along the normal, m/s; negative: it closes
    double before = 0.0;                          // the share at the start of the segment
  };
  enum class Friction { Free, KeepsDirection };
  // Points that come down in a segment, and go on until the next one.
  using Open = std::vector<TouchingPoint>;

  // A segment (exact_step.cpp). solve() corrects overlaps, makes the velocities of now obey the law, and finds a segment;
  // integrate() goes to its end.
  TouchingPoints find(double time, const LastNormals& last = {});
  void widenMargin();
  bool hasMissedContact(const TouchingPoints& later) const;
  double deepestShare(const TouchingPoints& touching) const;
  template <class Pushes>
  void addHeld(const CoulombBodies& bodies, const std::vector<CoulombPoint>& laws, const Pushes& pushes,
               std::vector<char>& held) const;
  Segment trySegment(double tau, Friction friction, const Open* open = nullptr);
  CoulombProblem firstKick(const Slip& slip, double tau, Friction friction) const;
  void solveAndDrift(CoulombProblem& kick, const CoulombBodies& at_start, double tau, Segment& segment);
  void solveSecondKick(const Slip& slip, const std::vector<BodyMotion>& start, double tau, Friction friction,
                       const Open* open, Segment& segment);
  // Points that a segment met and that were not known when it began.
  std::pair<Vec3, Vec3> takenBack(const TouchingPoint& point, const CoulombPoint& law,
                                  const std::vector<BodyMotion>& start, const std::vector<BodyMotion>& end,
                                  double tau) const;
  bool isElsewhere(const std::pair<Vec3, Vec3>& back, const TouchingPoint& known) const;
  std::optional<TouchingPoints> withUnforeseen(const Segment& segment, double tau) const;
  void addUnforeseen();
  void giveUp(Outcome why);
  Island& island() { return step_.islands[step_.island[island_.indices().front()]]; }

  // How long a segment is (exact_segments.cpp).
  double turnsBy(double seconds) const;
  double nextLength() const;
  void limitSegment();
  void lengthen();
  void findSegment();

  // Kicks (exact_kicks.cpp): Coulomb problems, what is expected of them, and what the drift between two of them curves.
  CoulombResult solveKick(CoulombProblem& problem, double tau);
  CoulombResult solveInBudget(CoulombProblem& problem, double tolerance, double wanted, double needed);
  CoulombResult kickAtInstant(TouchingPoints& touching, CoulombBodies& bodies, double seconds,
                              Friction friction);
  void solveVelocities();
  bool updateCurvature(const CoulombBodies& drifting, const std::vector<CoulombPoint>& laws,
                       const std::vector<char>& held, const std::vector<BodyMotion>& start,
                       const TouchingPoints& later, double tau, std::vector<Vec3>& curvature) const;
  bool areAsExpected(const TouchingPoints& touching, const std::vector<CoulombPoint>& laws,
                     double seconds) const;
  double lastingShare(const CoulombResult& result, const TouchingPoints& touching,
                      const std::vector<CoulombPoint>& laws, double seconds, const CoulombBodies& start,
                      const CoulombBodies& solved) const;
  void expectSecondKick(const CoulombProblem& kick, double lasting, double tau, Friction friction,
                        Segment& segment) const;
  void expectTorques(const CoulombProblem& kick, const CoulombBodies& drifted, double tau, Friction friction,
                     TouchingPoints& later) const;
  void addResiduals(const CoulombResult& result);

  // Overlaps, taken away by a displacement (exact_overlaps.cpp).
  bool correctOverlaps();
  bool isWayOut(const CoulombProblem& problem) const;
  void giveAngularMomentumBack(const CoulombProblem& displaced);

  // Where a velocity jumps, a segment ends (exact_landings.cpp): a point that was open comes down.
  bool comesDown(const TouchingPoint& point, const CoulombPoint& law, const Open& open,
                 const std::vector<BodyMotion>& start, const std::vector<BodyMotion>& end, double tau) const;
  Landing landingAfter(double tau, const Open& open);
  void letGo(double tau, Segment& segment);
  bool cutAtLanding(double& tau, Segment& segment);
  // Where there is a soft step, it does as well for groups.
  bool locatesLandings() const { return apart_ || !promoted_; }
  // Searches end with what the island has of its own: the rest of the step, and other islands, need what all have in common.
  bool hasRoomForLandings() const { return budget_.left > kCommonWork && !budget_.isSpent(); }

  // Where a force jumps, a segment ends (exact_stops.cpp): sliding stops, or a contact comes off.
  Slip slipNow() const;
  Vec3 turningOf(const CoulombBodies& bodies, const TorqueConstraint& torque) const;
  Left slipLeft(const Slip& slip, const TouchingPoints& later, const CoulombBodies& bodies,
                Friction friction) const;
  void cutAtStop(double& tau, Segment& segment);
  double pushAtStart(Index contact) const;
  double pushAtEnd(const Segment& segment, Index contact) const;
  std::optional<Loss> lossIn(const Segment& segment, double tau);
  bool cutAtLoss(const Loss& loss, double& tau, Segment& segment);

  // What no displacement frees gives way by its overlap (exact_squeeze.cpp).
  bool letYield(CoulombProblem& problem) const;
  bool isShort(const CoulombProblem& problem) const;
  bool findSqueezed(const CoulombProblem& problem);
  void leaveSqueezed(CoulombProblem& problem) const;
  bool isSqueezed(const TouchingPoint& point) const;
  double stiffnessOf(const TouchingPoint& point, const CoulombPoint& law) const;
  double elasticEnergy() const;
  void giveWay(const TouchingPoint& point, double tau, bool at_instant, CoulombPoint& law) const;
  void forgetSqueezed();
  double squeezingOf(const TouchingPoints& touching, const CoulombBodies& bodies) const;
  void judgeSqueezing();

  // Energy that nothing has given (exact_energy.cpp).
  double kineticOf(const std::vector<BodyMotion>& motions) const;
  Vec3 frameOfEnergy() const;
  double energyOf(const std::vector<BodyMotion>& motions, double seconds) const;
  double workByKinematic(const TouchingPoints& touching, const PointsOfContacts& opened, double time) const;
  double workOfTorques(const std::vector<BodyMotion>& start) const;
  double gainOf(const std::vector<BodyMotion>& start, double kinematic_before) const;

  Context& context_;
  StepStore& step_;
  std::vector<Index> active_;  // contacts
  IslandMotion island_;
  Slots slots_;  // in the problem
  SolveBudget& budget_;
  std::int64_t whole_budget_;
  bool ends_early_;
  InnerClock& clock_;
  double now_, end_, span_;
  double reach_ = 1.0;  // of the margin within which pairs are looked at
  double tolerance_, wanted_tolerance_;
  int corrections_, cuts_;
  bool promoted_;                // by a setting that has another method for it
  bool apart_;                   // no two of its bodies push each other when it begins
  double slow_;                  // a slip below is none
  TouchingPoints touching_;      // now
  std::vector<Index> squeezed_;  // contacts of what no displacement frees
  PointsOfContacts opened_;      // so far
  std::vector<Stop> stops_;      // at which segments have been cut
  std::vector<Index> losses_;    // contacts at whose loss segments have been cut, or would have been
  std::vector<BodyMotion> start_;
  Vec3 frame_v_W_ = Vec3::Zero();        // of the frame in which energies are judged, m/s
  IslandResiduals before_solves_, own_;  // of the island before this interval, and of this interval alone
  bool was_cut_short_ = false;           // the island, before this interval
  double longest_ = 0.0, tau_ = 0.0;     // a segment: at most, and this one, s
  std::map<Index, double> parted_;       // by contact: by how much its overlaps have been taken away, m
  int halvings_ = kMostHalvings;         // of it, left
  int good_ = 0;                         // good ones since it was halved or lengthened
  Segment segment_;                      // this one
  Outcome outcome_ = Outcome::Done;
};

}  // namespace rbs::exact_step

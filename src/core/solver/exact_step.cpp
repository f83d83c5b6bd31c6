// SPDX-License-Identifier: BSD-3-Clause
// Exact step: the Coulomb problem without softness, second order in time between located events.
//
// A segment of length tau goes from positions x0 and velocities v0 that obey the contact law to x1 and v1
// that do again. It is the RATTLE scheme (Andersen, J. Comput. Phys. 52, 1983) with unilateral contacts and
// friction: a kick of half the load, a drift, a kick of the other half, and impulses in both kicks,
//   v_half = v0 + M0^-1 (tau/2 f + J0^T r)   with r such that the gaps obey the law at the END of the drift,
//   x1     = x0 moved by v_half for tau      (rotation: the free top, which keeps L),
//   v1     = v_half + M1^-1 (tau/2 f + J1^T s)   with s such that the velocities obey the law at x1.
// Under constant forces and a fixed direction of sliding both are exact: a parabola, a braking box.
//
// Kick 1. At a point with gap d the normal law is on the gap that the drift will leave: d+ + tau u_n + c >=
// 0, with c what the curvature of the motion adds. c is what the narrow phase finds at x1 beyond the linear
// prediction; where it matters the kick is solved again with it. An overlap that is there already counts as
// closed (d+ = 0), so that it adds no speed; it is taken away by a displacement alone.
//
// At a point that friction holds, kick 1 stops the mean of the slip at x0 and the slip at x1, both under
// v_half. The two differ where a contact moves on its bodies: a disc rolls on its rim, a ball rides on a
// turntable. With J_mid = (J0 + J1)/2 this is J_mid,T v_half = 0, the midpoint rule for a constraint on
// velocities. It is of second order; J0,T v_half = 0 is of first (J. Cortes, S. Martinez, "Non-holonomic
// integrators", Nonlinearity 14, 2001).
//
// Kick 2 sees the points that touch at x1: those pushed by the first kick, or closed to rounding.
//
// Friction opposes u_half in the first kick. In the second it keeps that direction, which is the one of the
// middle of the segment, where the point goes on sliding; so the scheme stays of second order where sliding
// turns.
//
// What resists turning (TorqueConstraint) is friction with torques for forces: all that is said of sliding holds
// for rolling and spinning.
//
// Events. A velocity jumps where an open point comes down. The segment is cut there (exact_landings.cpp). Two things make the
// force jump. One is a stop: a sliding point that comes to rest (or begins to roll)
// within the segment, or a pair that stops rolling. The segment is then cut where its sliding speed, with friction still
// against the old direction, passes zero. The other is the loss of a support: a ball runs over an edge. The segment is then cut
// where it comes. The onset of sliding, and lift-off from what goes on below, are continuous in the force, so a step that
// misses them has an error of third order in its length. Impacts cut the segment from outside (impact_loop.h).
#include "solver/exact_stepper.h"

#include "solver/contact_preparation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rbs::exact_step {

namespace {

// A slip below this share of the speed unit is none. It must be more than the residual of a solve.
constexpr double kSlip = 1e-7, kSlipOverTolerance = 10.0;
// What solves aim at where a body is alone: Newton's method gets there in a step or two more, and what is at
// rest to rounding needs no solve in the next step. At `interactive` a body that moves is solved to the second of the two.
constexpr double kLoneTolerance = 1e-15, kLoneMoving = 1e-12;
// |w| tau of a body that is not a ball up to which a first estimate leaves out the curvature of the motion.
constexpr double kStraight = 0.01;
// Overlaps beyond this share are not left to the next step: so many corrections may go into them at any
// setting. Where the soft step would do as well, each has to leave less than the share kHelps of what the one before it
// left: what stays is at points that the solve does not have.
constexpr double kLeftOverlap = 1e-6, kHelps = 0.5;
constexpr int kMostCorrections = 6;
// A residual beyond this is no solution that is not quite converged, but none.
constexpr double kUnsolved = 1e-2;
// Share of the smaller bounding radius by which a point may move on both bodies in a segment and be the same.
constexpr double kJump = 0.5;
// A gain beyond this share comes of a solve that is far from one, or of points that were not where they were expected, as of a
// small ball that is squeezed out between two bodies.
constexpr double kRunsAway = 0.1;
// What it costs to find the points of a pair, in multiplications.
constexpr std::int64_t kPairWork = 5000;

// Whether a kinematic body that turns carries others. They stay on their circles by the curvature of their ways alone: without it
// a box creeps outwards by w^2 r h/2 a second.
bool isCarriedRound(const Context& context, const std::vector<Index>& contacts) {
  const Bodies& bodies = context.scene.bodies;
  const auto turns = [&](Index i) {
    return bodies.traits[i].is_kinematic() && !bodies.twist[i].w_WB.isZero(0.0);
  };
  return std::any_of(contacts.begin(), contacts.end(), [&](Index k) {
    const Contact& contact = context.scene.contacts.active[k];
    return turns(contact.i) || turns(contact.j);
  });
}

// Whether nothing has pushed a point yet that comes down without a rebound.
bool isOpen(const TouchingPoint& point) {
  return point.gap > kTouch * point.length && point.force_W.isZero(0.0) && std::isinf(point.rebounds_from);
}

std::vector<Index> sorted(std::vector<Index> list) {
  std::sort(list.begin(), list.end());
  return list;
}

}  // namespace

Stepper::Stepper(Context& context, const Subgraph& batch, double t0, double t1, SolveBudget& budget,
                 bool ends_early, InnerClock& clock)
    : context_(context),
      step_(context.step),
      active_(sorted(batch.contacts)),
      island_(context, sorted(batch.bodies)),
      slots_(context.step.slot),
      budget_(budget),
      whole_budget_(budget.left),
      ends_early_(ends_early),
      clock_(clock),
      now_(t0),
      end_(t1),
      span_(t1 - t0) {
  for (std::size_t k = 0; k < island_.indices().size(); ++k)
    slots_.set(island_.indices()[k], static_cast<Index>(k));
  const SolverSettings& settings = context.step.solver;
  apart_ = areApart(context, active_);
  tolerance_ = settings.tolerance;
  wanted_tolerance_ = settings.wanted_tolerance;
  if (island_.indices().size() == 1) {
    // As seen from what carries it.
    const double speed = context.scene.bodies.mostSpeed(island_.indices().front(), frameOfEnergy());
    const bool to_rounding = settings.exact || speed <= island_.loadSpeed();
    wanted_tolerance_ = std::min(wanted_tolerance_, to_rounding ? kLoneTolerance : kLoneMoving);
  }
  promoted_ = settings.promotes;
  corrections_ = std::max(settings.corrections, apart_ || isCarriedRound(context, active_) ? 1 : 0);
  cuts_ = promoted_ && !apart_ ? 0 : settings.cuts;
  slow_ = std::max(kSlip, kSlipOverTolerance * tolerance_) * island_.loadSpeed();
}

TouchingPoints Stepper::find(double time, const LastNormals& last) {
  clock_.charge(kSolve);
  TouchingPoints found = findTouching(context_, active_, slots_, time, span_, reach_, last);
  clock_.charge(kCollide);
  budget_.left -= kPairWork * static_cast<std::int64_t>(active_.size());
  return found;
}

// Whether a pair overlaps after a drift that was too far apart before it to be looked at: others have pushed
// it together.
bool Stepper::hasMissedContact(const TouchingPoints& later) const {
  return std::any_of(later.points.begin(), later.points.end(), [&](const TouchingPoint& point) {
    return point.gap < -kTouch * point.length && !touching_.has(point.contact);
  });
}

void Stepper::widenMargin() {
  reach_ *= 4.0;
  const TouchingPoints before = std::move(touching_);
  touching_ = find(now_);
  touching_.inherit(before, opened_);
}

// A point after a drift, as it lies on its two bodies, where these places were before it.
std::pair<Vec3, Vec3> Stepper::takenBack(const TouchingPoint& point, const CoulombPoint& law,
                                         const std::vector<BodyMotion>& start,
                                         const std::vector<BodyMotion>& end, double tau) const {
  const Bodies& bodies = context_.scene.bodies;
  const Contact& contact = context_.scene.contacts.active[point.contact];
  const auto back = [&](Index i, Index slot, const Vec3& p_W) -> Vec3 {
    const Pose from = slot == kNone ? step_.poseAt(bodies, i, now_) : start[slot].pose;
    const Pose to = slot == kNone ? step_.poseAt(bodies, i, now_ + tau) : end[slot].pose;
    return from.p_WB + from.q_WB * (to.q_WB.conjugate() * (p_W - to.p_WB));
  };
  const Vec3 half_W = 0.5 * point.gap * law.frame.col(2);
  return {back(contact.i, law.i, point.p_W - half_W), back(contact.j, law.j, point.p_W + half_W)};
}

// Whether a point after a drift, taken back, is another one than that of the same feature before it: the farthest point
// of a tilted rim goes to the other side of it. That of a ball travels over both surfaces as it rolls, however far.
bool Stepper::isElsewhere(const std::pair<Vec3, Vec3>& back, const TouchingPoint& known) const {
  const std::vector<Traits>& traits = context_.scene.bodies.traits;
  const Contact& contact = context_.scene.contacts.active[known.contact];
  if (traits[contact.i].round || traits[contact.j].round) return false;
  const double jump = kJump * std::min(traits[contact.i].bounding_radius, traits[contact.j].bounding_radius);
  return std::min((back.first - known.p_W).norm(), (back.second - known.p_W).norm()) > jump;
}

// The deepest overlap, as a share of the smaller length of its pair, but for what is squeezed; 0 for none.
double Stepper::deepestShare(const TouchingPoints& touching) const {
  double deepest = 0.0;
  for (const TouchingPoint& point : touching.points)
    if (!isSqueezed(point)) deepest = std::max(deepest, -point.gap / point.length);
  return deepest;
}

// The points of now and those that overlap after a drift and that the pair did not have before it: a hull
// rolls over onto another face, a rim comes round. The narrow phase shows the points of one facet only,
// however far it looks. Each is taken back with the material of its two bodies: what is apart by d and moves
// rigidly is apart by n.(p_j - p_i) at the start, where n is its normal after the drift. What the normal
// turns meanwhile is in the curvature. Nothing if there are none.
std::optional<TouchingPoints> Stepper::withUnforeseen(const Segment& segment, double tau) const {
  const Bodies& bodies = context_.scene.bodies;
  const std::vector<BodyMotion> start = island_.save();
  std::optional<TouchingPoints> all;
  for (std::size_t m = 0; m < segment.touching.points.size(); ++m) {
    TouchingPoint point = segment.touching.points[m];
    CoulombPoint law = segment.touching.law[m];
    if (point.gap >= -kLeftOverlap * point.length) continue;
    const Contact& contact = context_.scene.contacts.active[point.contact];
    const Vec3 n_W = law.frame.col(2);
    const auto [p_i, p_j] = takenBack(point, law, start, segment.end, tau);
    const Index known = touching_.matching(point);
    if (known != kNone && !isElsewhere({p_i, p_j}, touching_.points[known])) continue;
    if (!all) all = touching_;
    if (known != kNone) all->points[all->matching(point)].feature = SolvedPoint::kPassed;
    point.p_W = 0.5 * (p_i + p_j), point.gap = n_W.dot(p_j - p_i);
    point.force_W.setZero(), point.impulse_W.setZero();
    // One place for both keeps the angular momentum of the two. But the two places part as the bodies slip, and without
    // friction nothing may turn a ball: there it is the place on the ball, and of two balls the place on each.
    const bool round_i = law.mu == 0.0 && bodies.traits[contact.i].round;
    const bool round_j = law.mu == 0.0 && bodies.traits[contact.j].round;
    const Vec3 at_W = round_i ? p_i : round_j ? p_j : point.p_W;
    law.r_i = at_W - step_.poseAt(bodies, contact.i, now_).p_WB;
    law.r_j = (round_j ? p_j : at_W) - step_.poseAt(bodies, contact.j, now_).p_WB;
    if (law.i == kNone || law.j == kNone) law.axis_W = bodies.axis_W(law.i == kNone ? contact.j : contact.i);
    law.impulse.setZero(), law.slide.setZero();
    all->add(point, law);
  }
  return all;
}

// Adds the points that friction holds: of those that `pushes`, the ones that slip no faster than another point of their contact
// whose force is within the cone, or not at all. Friction of the corners of a face that sticks may be at its bound at some of
// them, and those are held like the others: held alone, the others would drag the face along. None is held in groups in which
// pairs resist rolling: there `reference` does not always reach its tolerance with the mean slip of a drift.
template <class Pushes>
void Stepper::addHeld(const CoulombBodies& bodies, const std::vector<CoulombPoint>& laws,
                      const Pushes& pushes, std::vector<char>& held) const {
  if (!touching_.torques.empty()) return;
  const auto slipOf = [&](std::size_t k) { return velocityAt(bodies, laws[k]).head<2>().norm(); };
  for (std::size_t first = 0, end = 0; first < laws.size(); first = end) {
    double fastest = slow_;
    for (; end < laws.size() && touching_.points[end].contact == touching_.points[first].contact; ++end)
      if (pushes(end) && isWithinCone(laws[end].impulse, laws[end].mu))
        fastest = std::max(fastest, slipOf(end));
    for (std::size_t k = first; k < end; ++k)
      held[k] = held[k] || (pushes(k) && laws[k].mu > 0.0 && slipOf(k) <= fastest);
  }
}

// Goes over a segment and back: the bodies are where they were, and the end is in what is returned.
Stepper::Segment Stepper::trySegment(double tau, Friction friction, const Open* open) {
  const std::vector<BodyMotion> start = island_.save();
  const CoulombBodies at_start = island_.bodies();
  const Slip slip = slipNow();
  CoulombProblem kick = firstKick(slip, tau, friction);
  Segment segment;
  solveAndDrift(kick, at_start, tau, segment);
  for (std::size_t k = 0; k < kick.points.size(); ++k)
    if (kick.points[k].impulse[2] > 0.0 && isOpen(touching_.points[k]))
      segment.landing.push_back(static_cast<Index>(k));
  const double lasting =
      lastingShare(segment.first, touching_, kick.points, 0.5 * tau, at_start, kick.bodies);
  expectSecondKick(kick, lasting, tau, friction, segment);
  solveSecondKick(slip, start, tau, friction, open, segment);
  segment.end = island_.save();
  island_.restore(start);
  return segment;
}

// With the impulses that the forces of now would give, and half of the load.
CoulombProblem Stepper::firstKick(const Slip& slip, double tau, Friction friction) const {
  CoulombProblem kick{island_.bodies(), touching_.law, 0.0};
  island_.addLoad(kick.bodies, 0.5 * tau);
  const bool keeps = friction == Friction::KeepsDirection;
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    CoulombPoint& law = kick.points[k];
    law.impulse = 0.5 * tau * (law.frame.transpose() * touching_.points[k].force_W);
    if (keeps && !slip.points[k].isZero(0.0)) law.slide = slip.points[k].normalized();
  }
  for (std::size_t k = 0; k < slip.torques.size(); ++k) {
    TorqueConstraint& law = kick.torques.emplace_back(touching_.torques[k].law);
    law.impulse = 0.5 * tau * (law.frame.transpose() * touching_.torques[k].force_W);
    const Vec3& u = slip.torques[k];
    if (keeps && !u.head<2>().isZero(0.0)) law.rolls = u.head<2>().normalized();
    if (keeps && u[2] != 0.0) law.spins = std::copysign(1.0, u[2]);
  }
  return kick;
}

// The first kick and the drift, again while the curvature that the drift shows asks for another kick.
void Stepper::solveAndDrift(CoulombProblem& kick, const CoulombBodies& at_start, double tau,
                            Segment& segment) {
  const std::vector<BodyMotion> start = island_.save();
  const CoulombBodies loaded = kick.bodies;
  std::vector<char> held(kick.points.size());
  addHeld(
      at_start, kick.points,
      [&](std::size_t k) {
        const TouchingPoint& point = touching_.points[k];
        return point.gap <= (point.force_W.isZero(0.0) ? kTouch : kPushedGap) * point.length;
      },
      held);
  std::vector<Vec3> curvature(kick.points.size(), Vec3::Zero());
  if (corrections_ > 0 && island_.indices().size() == 1 && turnsBy(tau) > kStraight) {
    // The turn of a body tells most of it, where no others push it.
    island_.drift(at_start, tau);
    const TouchingPoints ahead = find(now_ + tau, {&touching_, &kick.points, 0.5 * tau});
    updateCurvature(at_start, kick.points, held, start, ahead, tau, curvature);
    island_.restore(start);
  }
  double deepest = std::numeric_limits<double>::infinity();
  for (int corrections = 0;; ++corrections) {
    for (std::size_t k = 0; k < kick.points.size(); ++k) {
      kick.points[k].bias = touching_.law[k].bias + curvature[k] / tau +
                            Vec3(0.0, 0.0, std::max(touching_.points[k].gap, 0.0) / tau);
      giveWay(touching_.points[k], tau, false, kick.points[k]);
    }
    kick.bodies = loaded;
    segment.first = solveKick(kick, tau);
    addHeld(
        kick.bodies, kick.points, [&](std::size_t k) { return kick.points[k].impulse[2] > 0.0; }, held);
    island_.drift(kick.bodies, tau);
    segment.touching = find(now_ + tau, {&touching_, &kick.points, 0.5 * tau});
    const bool matters =
        updateCurvature(kick.bodies, kick.points, held, start, segment.touching, tau, curvature);
    const double before = std::exchange(deepest, deepestShare(segment.touching));
    const bool helps = !promoted_ || deepest < kHelps * before;
    const bool deep = tellsWay(segment.first) && deepest > kLeftOverlap && helps;
    if (!matters || corrections >= (deep ? kMostCorrections : corrections_) || budget_.isSpent()) break;
    island_.restore(start);
  }
}

// The other half of the load, and impulses at the points that touch after the drift.
void Stepper::solveSecondKick(const Slip& slip, const std::vector<BodyMotion>& start, double tau,
                              Friction friction, const Open* open, Segment& segment) {
  TouchingPoints& later = segment.touching;
  const CoulombBodies drifted = island_.bodies();
  CoulombBodies after = drifted;
  island_.addLoad(after, 0.5 * tau);
  TouchingPoints aimed = later;
  if (open) {
    const std::vector<BodyMotion> end = island_.save();
    for (std::size_t k = 0; k < aimed.points.size(); ++k)
      if (comesDown(aimed.points[k], aimed.law[k], *open, start, end, tau))
        aimed.points[k].gap = std::numeric_limits<double>::infinity();
  }
  segment.second = kickAtInstant(aimed, after, 0.5 * tau, friction);
  island_.setTwists(after);
  segment.squeezing = squeezingOf(later, after);
  const double lasting = lastingShare(segment.second, later, aimed.law, 0.5 * tau, drifted, after);
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    TouchingPoint& point = later.points[k];
    const Vec3 impulse_W = aimed.law[k].frame * aimed.law[k].impulse;
    point.force_W = expectedNext(point.force_W, 2.0 / tau * impulse_W, lasting);
    point.impulse_W += impulse_W;
    segment.push.push_back(2.0 / tau * aimed.law[k].impulse[2]);
    later.law[k].slide.setZero();
  }
  for (std::size_t k = 0; k < later.torques.size(); ++k) {
    TorqueConstraint& law = later.torques[k].law;
    later.torques[k].force_W = 2.0 / tau * (law.frame * aimed.torques[k].law.impulse);
    law.rolls.setZero(), law.spins = 0.0;
  }
  if (friction == Friction::Free || (segment.first.converged && segment.second.converged))
    segment.slip_left = slipLeft(slip, later, after, friction);
}

void Stepper::collide() {
  touching_ = find(now_);
}

void Stepper::prepare() {
  start_ = island_.save();
  frame_v_W_ = frameOfEnergy();
  before_solves_ = island().residuals;
  was_cut_short_ = island().cut_short;
  expectLastForces(context_.scene.contacts, touching_);
  longest_ = end_ - now_;
}

// Goes back to the start, where another method is to begin.
void Stepper::giveUp(Outcome why) {
  outcome_ = why;
  island().cut_short = was_cut_short_ || why == Outcome::OverBudget;
  island_.restore(start_);
  island().residuals = before_solves_;
}

// A sub-step is a segment.
bool Stepper::beginSubStep() {
  if (!isGoing() || end_ - now_ <= 1e-12 * step_.h()) return false;
  limitSegment();
  if (!budget_.isOut()) return true;
  giveUp(Outcome::OverBudget);
  return false;
}

// Goes over the segment again with the points that it met and that were not among those of now.
void Stepper::addUnforeseen() {
  for (int more = 0; more < kMostCorrections && tellsWay(segment_.first); ++more) {
    std::optional<TouchingPoints> other = withUnforeseen(segment_, tau_);
    if (!other) return;
    std::swap(touching_, *other);
    Segment next = trySegment(tau_, Friction::Free);
    // A point more takes energy away. Where it adds some, what was foreseen of it was wrong.
    const double most = std::max(energyOf(island_.save(), 0.0), energyOf(segment_.end, tau_));
    if (!tellsWay(next.first) || energyOf(next.end, tau_) > most) {
      std::swap(touching_, *other);
      return;
    }
    segment_ = std::move(next);
  }
}

void Stepper::solve() {
  if (correctOverlaps()) {
    const TouchingPoints before = std::move(touching_);
    touching_ = find(now_);
    touching_.inherit(before, opened_);
  }
  if (!isGoing()) return;
  const std::vector<BodyMotion> start = island_.save();
  const double kinematic_before = workByKinematic(touching_, opened_, now_);
  solveVelocities();
  if (locatesLandings()) limitSegment();  // what has landed turns otherwise now
  findSegment();
  const Outcome failure = budget_.isOut() ? Outcome::OverBudget : Outcome::NoSolution;
  if (isGoing() && gainOf(start, kinematic_before) > kRunsAway) return giveUp(failure);
  addResiduals(segment_.first);
  addResiduals(segment_.second);
  const double worst = std::max({own_.signorini, own_.coulomb, own_.dissipation});
  if (!own_.converged && worst > kUnsolved && (promoted_ || !budget_.isLate())) return giveUp(failure);
  if (!own_.converged && promoted_ && budget_.isOut()) return giveUp(failure);  // the soft step does better
  judgeSqueezing();
}

// Goes to where the segment ends.
void Stepper::integrate() {
  if (!isGoing()) return;
  island_.restore(segment_.end);
  touching_ = std::move(segment_.touching);
  opened_.insert(opened_.end(), segment_.opened.begin(), segment_.opened.end());
  now_ += tau_;
  reach_ = 1.0;
}

void Stepper::store() {
  if (!ends_early_ && budget_.isOut()) giveUp(Outcome::OverBudget);
  if (!isGoing()) return;
  storeTouching(touching_, opened_, active_, context_.scene.contacts);
  forgetSqueezed();
}

namespace {

Island& islandOf(StepStore& step, const Subgraph& batch) {
  return step.islands[step.island[batch.bodies.front()]];
}

Outcome runWith(SolveBudget& budget, bool ends_early, Context& context, const Subgraph& batch, double t0,
                double t1, std::vector<double>& row_seconds) {
  InnerClock clock(row_seconds);
  Stepper method(context, batch, t0, t1, budget, ends_early, clock);
  runInnerStep(method, clock);
  return method.outcome();
}

}  // namespace

Outcome advance(Context& context, const Subgraph& batch, double t0, double t1) {
  if (!(t1 > t0)) return Outcome::Done;
  StepStore& step = context.step;
  std::int64_t& own = islandOf(step, batch).work_left;
  std::int64_t none = 0;
  std::int64_t& common = step.solver.exact ? step.solve_budget.left : none;
  const std::int64_t all = own + kCommonWork;
  SolveBudget budget{all, step.solve_budget.until, kCommonWork - common};
  const Outcome outcome = runWith(budget, true, context, batch, t0, t1, step.row_seconds);
  const std::int64_t spent = std::min(all - budget.left, own + common), of_own = std::min(spent, own);
  own -= of_own;
  common -= spent - of_own;
  return outcome;
}

std::optional<Outcome> advanceByItsOwn(Context& context, const Subgraph& batch, double t0, double t1,
                                       std::vector<double>& row_seconds) {
  if (!(t1 > t0)) return Outcome::Done;
  Island& island = islandOf(context.step, batch);
  const std::int64_t all = island.work_left + kCommonWork;
  const bool cut_short = island.cut_short;
  std::vector<SeparatingAxis> axes;  // with the counts of their queries
  for (const Index k : batch.contacts) axes.push_back(context.scene.contacts.active[k].axis);
  SolveBudget budget{all, context.step.solve_budget.until, kCommonWork};
  const Outcome outcome = runWith(budget, !context.step.solver.exact, context, batch, t0, t1, row_seconds);
  if (outcome == Outcome::OverBudget && context.step.solver.exact) {
    island.cut_short = cut_short;
    auto axis = axes.begin();
    for (const Index k : batch.contacts) context.scene.contacts.active[k].axis = *axis++;
    return std::nullopt;
  }
  island.work_left -= std::min(island.work_left, all - budget.left);
  return outcome;
}

}  // namespace rbs::exact_step

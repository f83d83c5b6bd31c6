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
// Kick 2 sees the points that touch at x1: those pushed by the first kick, or closed to rounding.
//
// Friction opposes u_half in the first kick. In the second it keeps that direction, which is the one of the
// middle of the segment, where the point goes on sliding; so the scheme stays of second order where sliding
// turns.
//
// What resists turning (CoulombCouple) is friction with torques for forces: all that is said of sliding holds
// for rolling and spinning.
//
// Events. Only a stop makes the force jump: a sliding point that comes to rest (or begins to roll) within the
// segment, or a pair that stops rolling. The segment is then cut where its sliding speed, with friction still
// against the old direction, passes zero. The onset of sliding and lift-off are continuous in the force, so a
// step that oversees them is wrong by the third power of its length. Impacts cut the segment from outside
// (impact_loop.h).
#include "certificate.h"
#include "fidelity.h"
#include "methods/island_motion.h"
#include "methods/methods.h"
#include "methods/touching.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rbs::exact_step {

namespace {

// Shares of the smaller length of a pair. A gap below kTouch is closed; a pushed point is taken for closed up
// to kPushed, which is more than the curvature of the drift leaves; an overlap beyond kOverlap is taken away, if it
// is more than what kicks leave that are right to ten times the aim; curvature beyond kCurved is given back to the
// first kick.
constexpr double kTouch = 1e-7, kPushed = 1e-3, kOverlap = 1e-11, kCurved = 1e-10;
// A slip below this share of the speed unit is none. It must be more than the residual of a solve.
constexpr double kSlip = 1e-7, kSlipOverAim = 10.0;
// Forces that change by less than this many times what solves aim at are as expected.
constexpr double kNoChange = 4.0;
// What solves aim at where a body is alone: Newton's method gets there in a step or two more, and what is at rest
// to rounding needs no solve in the next step.
constexpr double kLoneAim = 1e-12;
// |w| tau of a body that is not a ball, and the most segments that it may ask for.
constexpr double kTurn = 0.2;
constexpr int kMostSegments = 64;
// Overlaps beyond this share are not left to the next step: so many corrections may go into them at any setting.
constexpr double kDeep = 1e-6;
constexpr int kMostCorrections = 4;
// In a heap that comes to rest a point may stop and slide again without end. It cuts a step no more often than this.
constexpr int kMostStops = 2;
// Of the margin at which pairs are looked at: where to stop widening it.
constexpr double kFarthest = 256.0;

using Vec2 = Eigen::Vector2d;

const char* nameOf(CoulombSolver solver) {
  switch (solver) {
    case CoulombSolver::Guess:
      return "guess";
    case CoulombSolver::GaussSeidel:
      return "gauss_seidel";
    case CoulombSolver::Newton:
      return "newton";
    case CoulombSolver::InteriorPoint:
      return "interior_point";
    case CoulombSolver::Admm:
      break;
  }
  return "admm";
}

class Stepper {
 public:
  Stepper(Context& context, const IslandBatch& batch, double t0, double t1);

  bool run();
  void store();

 private:
  // How fast closed points slide, and couples turn, in their frames; zero where they do not.
  struct Slip {
    std::vector<Vec2> points;
    std::vector<Vec3> couples;
  };
  // What may stop: the sliding of a point, or the turning of a pair.
  using Stop = std::pair<Index, std::optional<std::uint32_t>>;  // pair; feature of the point
  // What a segment has left of the sliding, or turning, that has lost the most of its speed.
  struct Left {
    double share = 1.0;  // <= 0: it has stopped
    double speed = 0.0;  // before the segment, m/s
    Stop of{};
  };
  // How a segment ends.
  struct Segment {
    std::vector<BodyMotion> end;
    Touching touching;
    CoulombResult first, second;  // of its kicks
    Left slip_left;
  };
  enum class Friction { Free, KeepsDirection };

  Touching find(double time);
  bool overlooked(const Touching& later) const;
  void lookFarther();
  bool takeOverlapsAway();
  void settle();
  Segment attempt(double tau, Friction friction);
  Slip slipNow() const;
  Vec3 turningOf(const Movers& movers, const CoulombCouple& couple) const;
  bool asExpected(const Touching& touching, const std::vector<CoulombPoint>& laws, double seconds) const;
  bool curvatureMatters(const CoulombProblem& kick, const Touching& later, double tau,
                        std::vector<double>& curvature) const;
  void aimSecondKick(const CoulombProblem& kick, double tau, Friction friction, Touching& later) const;
  void aimCouples(const CoulombProblem& kick, const Movers& drifted, double tau, Friction friction,
                  Touching& later) const;
  CoulombResult kickAtInstant(Touching& touching, Movers& movers, double seconds, Friction friction) const;
  Left slipLeft(const Slip& slip, const Touching& later, const Movers& movers, Friction friction) const;
  void cutAtStop(double& tau, Segment& segment);

  CoulombResult solve(CoulombProblem& problem) const;
  IslandCertificate& islandCertificate() const;
  void certify(const CoulombResult& result) const;

  Context& context_;
  StepStore& step_;
  std::vector<Index> pairs_;
  IslandMotion island_;
  std::vector<Index> slot_;  // by body: its place in the problem
  ContactClock clock_;
  double now_, end_, span_;
  double reach_ = 1.0;  // of the margin within which pairs are looked at
  double tolerance_, aim_;
  int corrections_, cuts_;
  bool promoted_;      // by a setting that has another method for it
  double slow_;        // a slip below is none
  Touching touching_;  // now
  std::vector<Stop> stops_;  // at which segments have been cut
};

std::vector<Index> sorted(std::vector<Index> list) {
  std::sort(list.begin(), list.end());
  return list;
}

Stepper::Stepper(Context& context, const IslandBatch& batch, double t0, double t1)
    : context_(context),
      step_(context.step),
      pairs_(sorted(batch.pairs)),
      island_(context, sorted(batch.bodies)),
      slot_(context.scene.bodies.size(), kNone),
      clock_(step_),
      now_(t0),
      end_(t1),
      span_(t1 - t0) {
  for (std::size_t k = 0; k < island_.indices().size(); ++k)
    slot_[island_.indices()[k]] = static_cast<Index>(k);
  const FidelitySettings settings = settingsOf(context.scene.settings.fidelity);
  tolerance_ = settings.tolerance;
  aim_ = island_.indices().size() == 1 ? std::min(settings.aim, kLoneAim) : settings.aim;
  corrections_ = settings.corrections;
  cuts_ = settings.cuts;
  promoted_ = settings.promotes;
  slow_ = std::max(kSlip, kSlipOverAim * aim_) * island_.loadSpeed();
}

Touching Stepper::find(double time) {
  clock_.charge(kSolve);
  Touching found = findTouching(context_, pairs_, slot_, time, span_, reach_);
  clock_.charge(kCollide);
  return found;
}

bool overlaps(const Touching& touching) {
  return std::any_of(touching.points.begin(), touching.points.end(),
                     [](const TouchingPoint& point) { return point.gap < -kDeep * point.length; });
}

// Whether a pair overlaps after a drift that was too far apart before it to be looked at: others have pushed
// it together.
bool Stepper::overlooked(const Touching& later) const {
  return std::any_of(later.points.begin(), later.points.end(), [&](const TouchingPoint& point) {
    return point.gap < -kTouch * point.length && !touching_.has(point.pair);
  });
}

void Stepper::lookFarther() {
  reach_ *= 4.0;
  const Touching before = std::move(touching_);
  touching_ = find(now_);
  touching_.inherit(before);
}

// --- solving

// Residuals are measured against what the load does in a step, or the fastest closing where that is more.
CoulombResult Stepper::solve(CoulombProblem& problem) const {
  problem.speed_unit = island_.loadSpeed();
  for (const CoulombPoint& law : problem.points)
    problem.speed_unit = std::max(problem.speed_unit, -velocityAt(problem.bodies, law)[2]);
  if (!(problem.speed_unit > 0.0)) {
    for (CoulombPoint& law : problem.points) law.impulse.setZero();
    for (CoulombCouple& law : problem.couples) law.impulse.setZero();
    return {CoulombSolver::Guess, 0, 0.0, 0.0, 0.0, true};
  }
  problem.until = step_.solve_until;
  const CoulombResult result = solveCoulomb(problem, tolerance_, aim_);
  islandCertificate().iterations += static_cast<std::uint32_t>(result.iterations);
  return result;
}

IslandCertificate& Stepper::islandCertificate() const {
  return step_.islands[step_.island[island_.indices().front()]].certificate;
}

// Of a solve that counts: trials that are given up cost iterations and say nothing of the result.
void Stepper::certify(const CoulombResult& result) const {
  IslandCertificate solved;
  solved.method = nameOf(result.solver);
  solved.signorini = result.signorini;
  solved.coulomb = result.coulomb;
  solved.dissipation = result.dissipation;
  solved.converged = result.converged;
  certificate::add(islandCertificate(), solved);
}

// By a displacement d: M d = J^T l, 0 <= l, 0 <= J d + gap, their product zero. The same law, without
// friction and with lengths for velocities. What the shift by l n at a point makes of the angular momentum of
// the two bodies, l n x (v_j - v_i), they give back in halves, by their spin.
bool Stepper::takeOverlapsAway() {
  const double left_by_kicks = 10.0 * aim_ * island_.loadSpeed() * step_.h();
  CoulombProblem problem{island_.movers(), touching_.law, 0.0};
  for (CoulombBody& body : problem.bodies) body.v.setZero(), body.w.setZero();
  for (std::size_t k = 0; k < touching_.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    CoulombPoint& law = problem.points[k];
    law.mu = 0.0;
    law.drive = Vec3(0.0, 0.0, std::max(point.gap, -point.push * (end_ - now_)));
    if (point.gap < -std::max(kOverlap * point.length, left_by_kicks))
      problem.speed_unit = std::max(problem.speed_unit, -law.drive[2]);
  }
  if (problem.speed_unit == 0.0) return false;
  problem.until = step_.solve_until;
  solveCoulomb(problem, 1e-6);
  island_.displace(problem.bodies);
  Movers bodies = island_.movers();
  const Movers before = bodies;
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const CoulombPoint& law = problem.points[k];
    // What nothing but friction could turn is not turned for the sake of rounding.
    if (law.i == kNone || law.j == kNone || touching_.law[k].mu == 0.0) continue;
    const Vec3 shift_W = law.impulse[2] * law.frame.col(2);
    const Vec3 half_W = 0.5 * shift_W.cross(before[law.j].v - before[law.i].v);
    for (const Index body : {law.i, law.j}) bodies[body].w -= bodies[body].inertia_W.llt().solve(half_W);
  }
  island_.setTwists(bodies);
  return true;
}

// Makes velocities obey the law at this instant, under `seconds` of the forces that are expected; 0 for an
// impact without restitution.
CoulombResult Stepper::kickAtInstant(Touching& touching, Movers& movers, double seconds,
                                     Friction friction) const {
  CoulombProblem problem{movers, {}, 0.0};
  problem.points.reserve(touching.points.size());
  std::vector<std::size_t> closed;
  closed.reserve(touching.points.size());
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    const TouchingPoint& point = touching.points[k];
    const bool pushed = seconds > 0.0 && !point.force_W.isZero(0.0);
    if (point.gap > (pushed ? kPushed : kTouch) * point.length) continue;
    closed.push_back(k);
    problem.points.push_back(touching.law[k]);
    problem.points.back().impulse = seconds * (touching.law[k].frame.transpose() * point.force_W);
  }
  std::vector<std::size_t> borne;
  for (std::size_t k = 0; k < touching.couples.size(); ++k) {
    const TouchingCouple& couple = touching.couples[k];
    const auto place = [&](Index point) {
      return static_cast<Index>(std::lower_bound(closed.begin(), closed.end(), point) - closed.begin());
    };
    CoulombCouple law = couple.law;
    law.first = place(couple.law.first);
    law.size = place(couple.law.first + couple.law.size) - law.first;
    if (law.size == 0) continue;
    law.impulse = seconds * (law.frame.transpose() * couple.force_W);
    borne.push_back(k);
    problem.couples.push_back(law);
  }
  CoulombResult result = solve(problem);
  if (friction == Friction::Free) {
    // A point that would be driven back by its friction has stopped: there the law decides.
    for (bool fixed = true; fixed;) {
      fixed = false;
      for (CoulombPoint& law : problem.points) {
        if (law.slide.isZero(0.0)) continue;
        if (result.converged && law.slide.dot(velocityAt(problem.bodies, law).head<2>()) >= 0.0) continue;
        law.slide.setZero();
        fixed = true;
      }
      for (CoulombCouple& law : problem.couples) {
        const Vec3 u = turningAt(problem.bodies, law);
        if (!law.rolls.isZero(0.0) && !(result.converged && law.rolls.dot(u.head<2>()) >= 0.0))
          law.rolls.setZero(), fixed = true;
        if (law.spins != 0.0 && !(result.converged && law.spins * u[2] >= 0.0)) law.spins = 0.0, fixed = true;
      }
      if (!fixed) break;
      problem.bodies = movers;
      result = solve(problem);
    }
  }
  movers = problem.bodies;
  for (std::size_t k = 0; k < closed.size(); ++k) touching.law[closed[k]] = problem.points[k];
  for (std::size_t k = 0; k < borne.size(); ++k)
    touching.couples[borne[k]].law.impulse = problem.couples[k].impulse;
  return result;
}

void Stepper::settle() {
  Movers after = island_.movers();
  Touching touching = touching_;
  certify(kickAtInstant(touching, after, 0.0, Friction::Free));
  island_.setTwists(after);
  for (std::size_t k = 0; k < touching_.points.size(); ++k)
    touching_.points[k].impulse_W += touching.law[k].frame * touching.law[k].impulse;
}

// --- one segment

// What a couple resists of how its pair turns; zero where it does not turn, or nothing resists.
Vec3 Stepper::turningOf(const Movers& movers, const CoulombCouple& couple) const {
  Vec3 u = turningAt(movers, couple);
  if (couple.roll == 0.0 || u.head<2>().norm() <= slow_) u.head<2>().setZero();
  if (couple.spin == 0.0 || std::abs(u[2]) <= slow_) u[2] = 0.0;
  return u;
}

Stepper::Slip Stepper::slipNow() const {
  const Movers now = island_.movers();
  Slip slip{std::vector<Vec2>(touching_.points.size(), Vec2::Zero()), {}};
  for (const TouchingCouple& couple : touching_.couples) {
    bool closed = false;
    for (Index k = couple.law.first; k < couple.law.first + couple.law.size; ++k)
      closed = closed || touching_.points[k].gap <= kTouch * touching_.points[k].length;
    slip.couples.push_back(closed ? turningOf(now, couple.law) : Vec3(Vec3::Zero()));
  }
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    if (touching_.law[k].mu == 0.0 || point.gap > kTouch * point.length) continue;
    const Vec2 u_T = velocityAt(now, touching_.law[k]).head<2>();
    if (u_T.norm() > slow_) slip.points[k] = u_T;
  }
  return slip;
}

// What the drift has added to the gaps beyond tau u_n, and whether that is more than the kick reckoned with.
bool Stepper::curvatureMatters(const CoulombProblem& kick, const Touching& later, double tau,
                               std::vector<double>& curvature) const {
  bool matters = false;
  for (std::size_t k = 0; k < curvature.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    const Index m = later.matching(point);
    if (m == kNone) continue;
    const double allowed = kick.points[k].drive[2] - touching_.law[k].drive[2];
    const double u_n = velocityAt(kick.bodies, kick.points[k])[2] - allowed;
    const double c = later.points[m].gap - point.gap - tau * u_n;
    if (kick.points[k].impulse[2] > 0.0 || later.points[m].gap < 0.0)
      matters = matters || std::abs(c - curvature[k]) > kCurved * point.length;
    curvature[k] = c;
  }
  return matters;
}

// Whether impulses are those of the forces expected but for a few times what solves aim at. Such a change
// makes good what the guesses of earlier kicks have left; were it expected again, the next kicks would make
// good the opposite, for ever.
bool Stepper::asExpected(const Touching& touching, const std::vector<CoulombPoint>& laws,
                         double seconds) const {
  double change = 0.0;
  for (std::size_t k = 0; k < laws.size(); ++k)
    change =
        std::max(change, (laws[k].frame * laws[k].impulse - seconds * touching.points[k].force_W).norm());
  return change <= kNoChange * aim_ * island_.mass() * island_.loadSpeed();
}

// Hands the forces of the first kick on as what is expected of the second, with the directions of sliding.
void Stepper::aimSecondKick(const CoulombProblem& kick, double tau, Friction friction,
                            Touching& later) const {
  const Movers drifted = island_.movers();
  const bool expected = asExpected(touching_, kick.points, 0.5 * tau);
  for (std::size_t k = 0; k < kick.points.size(); ++k) {
    const CoulombPoint& law = kick.points[k];
    const Index m = later.matching(touching_.points[k]);
    if (m == kNone) continue;
    const Vec3 impulse_W = law.frame * law.impulse;
    later.points[m].force_W = expected ? touching_.points[k].force_W : Vec3(2.0 / tau * impulse_W);
    later.points[m].impulse_W = touching_.points[k].impulse_W + impulse_W;
    const Vec2 u_T = velocityAt(kick.bodies, law).head<2>();
    const bool slides = friction == Friction::KeepsDirection ? !law.slide.isZero(0.0) : u_T.norm() > slow_;
    if (law.mu == 0.0 || !(law.impulse[2] > 0.0) || !slides) continue;
    const Vec2 ahead = velocityAt(drifted, later.law[m]).head<2>();
    if (ahead.isZero(0.0)) continue;
    later.law[m].slide = ahead.normalized();
    if (friction == Friction::KeepsDirection && u_T.dot(law.slide) < 0.0) later.law[m].slide *= -1.0;
  }
  aimCouples(kick, drifted, tau, friction, later);
}

void Stepper::aimCouples(const CoulombProblem& kick, const Movers& drifted, double tau, Friction friction,
                         Touching& later) const {
  for (std::size_t k = 0; k < kick.couples.size(); ++k) {
    const CoulombCouple& law = kick.couples[k];
    const Index m = later.matching(touching_.couples[k]);
    if (m == kNone) continue;
    later.couples[m].force_W = 2.0 / tau * (law.frame * law.impulse);
    double n = 0.0;
    for (Index p = law.first; p < law.first + law.size; ++p) n += kick.points[p].impulse[2];
    if (!(n > 0.0)) continue;
    CoulombCouple& aimed = later.couples[m].law;
    const Vec3 u = turningOf(kick.bodies, law), ahead = turningAt(drifted, aimed);
    const bool keeps = friction == Friction::KeepsDirection;
    if (keeps ? !law.rolls.isZero(0.0) : !u.head<2>().isZero(0.0)) aimed.rolls = ahead.head<2>().normalized();
    if (keeps && u.head<2>().dot(law.rolls) < 0.0) aimed.rolls *= -1.0;
    if (keeps ? law.spins != 0.0 : u[2] != 0.0) aimed.spins = std::copysign(1.0, ahead[2]);
    if (keeps && u[2] * law.spins < 0.0) aimed.spins *= -1.0;
  }
}

Stepper::Left Stepper::slipLeft(const Slip& slip, const Touching& later, const Movers& movers,
                         Friction friction) const {
  Left least;
  const auto keeps = [&](const Vec3& left_W, const Vec3& before_W, const Stop& of) {
    const double share = left_W.dot(before_W) / before_W.squaredNorm();
    if (share < least.share && std::count(stops_.begin(), stops_.end(), of) < kMostStops)
      least = {share, before_W.norm(), of};
  };
  for (std::size_t k = 0; k < slip.couples.size(); ++k) {
    const Index m = later.matching(touching_.couples[k]);
    if (m == kNone || later.couples[m].force_W.isZero(0.0)) continue;
    const Vec3 u = turningAt(movers, later.couples[m].law), left_W = later.couples[m].law.frame * u;
    const Mat3& frame = touching_.couples[k].law.frame;
    const bool free = friction == Friction::Free;
    if (!slip.couples[k].head<2>().isZero(0.0) && !(free && u.head<2>().norm() > slow_))
      keeps(left_W, frame.leftCols<2>() * slip.couples[k].head<2>(), {touching_.couples[k].pair, {}});
    if (slip.couples[k][2] != 0.0 && !(free && std::abs(u[2]) > slow_))
      keeps(left_W, frame.col(2) * slip.couples[k][2], {touching_.couples[k].pair, {}});
  }
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    if (slip.points[k].isZero(0.0)) continue;
    const Index m = later.matching(touching_.points[k]);
    if (m == kNone || later.points[m].force_W.isZero(0.0)) continue;
    const Vec3 u = velocityAt(movers, later.law[m]);
    if (friction == Friction::Free && u.head<2>().norm() > slow_) continue;
    keeps(later.law[m].frame * u, touching_.law[k].frame.leftCols<2>() * slip.points[k],
          {touching_.points[k].pair, touching_.points[k].feature});
  }
  return least;
}

// Goes over a segment and back: the bodies are where they were, and the end is in what is returned.
Stepper::Segment Stepper::attempt(double tau, Friction friction) {
  const std::vector<BodyMotion> start = island_.save();
  const Slip slip = slipNow();
  CoulombProblem kick{island_.movers(), touching_.law, 0.0};
  island_.addLoad(kick.bodies, 0.5 * tau);
  const Movers loaded = kick.bodies;
  const bool keeps = friction == Friction::KeepsDirection;
  for (std::size_t k = 0; k < slip.points.size(); ++k) {
    CoulombPoint& law = kick.points[k];
    law.impulse = 0.5 * tau * (law.frame.transpose() * touching_.points[k].force_W);
    if (keeps && !slip.points[k].isZero(0.0)) law.slide = slip.points[k].normalized();
  }
  for (std::size_t k = 0; k < slip.couples.size(); ++k) {
    CoulombCouple& law = kick.couples.emplace_back(touching_.couples[k].law);
    law.impulse = 0.5 * tau * (law.frame.transpose() * touching_.couples[k].force_W);
    const Vec3& u = slip.couples[k];
    if (keeps && !u.head<2>().isZero(0.0)) law.rolls = u.head<2>().normalized();
    if (keeps && u[2] != 0.0) law.spins = std::copysign(1.0, u[2]);
  }

  Segment segment;
  std::vector<double> curvature(slip.points.size(), 0.0);
  for (int corrections = 0;; ++corrections) {
    for (std::size_t k = 0; k < slip.points.size(); ++k)
      kick.points[k].drive[2] =
          touching_.law[k].drive[2] + (std::max(touching_.points[k].gap, 0.0) + curvature[k]) / tau;
    kick.bodies = loaded;
    segment.first = solve(kick);
    island_.drift(kick.bodies, tau);
    segment.touching = find(now_ + tau);
    const bool matters = curvatureMatters(kick, segment.touching, tau, curvature);
    const bool deep = segment.first.converged && overlaps(segment.touching);
    if (!matters || corrections >= (deep ? kMostCorrections : corrections_) || step_.isLate()) break;
    island_.restore(start);
  }

  Touching& later = segment.touching;
  aimSecondKick(kick, tau, friction, later);
  Movers after = island_.movers();
  island_.addLoad(after, 0.5 * tau);
  Touching aimed = later;
  segment.second = kickAtInstant(aimed, after, 0.5 * tau, friction);
  island_.setTwists(after);
  const bool expected = asExpected(later, aimed.law, 0.5 * tau);
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    TouchingPoint& point = later.points[k];
    const Vec3 impulse_W = aimed.law[k].frame * aimed.law[k].impulse;
    if (!expected) point.force_W = 2.0 / tau * impulse_W;
    point.impulse_W += impulse_W;
    later.law[k].slide.setZero();
  }
  for (std::size_t k = 0; k < later.couples.size(); ++k) {
    CoulombCouple& law = later.couples[k].law;
    later.couples[k].force_W = 2.0 / tau * (law.frame * aimed.couples[k].law.impulse);
    law.rolls.setZero(), law.spins = 0.0;
  }
  if (friction == Friction::Free || (segment.first.converged && segment.second.converged))
    segment.slip_left = slipLeft(slip, later, after, friction);
  segment.end = island_.save();
  island_.restore(start);
  return segment;
}

// Finds where the first sliding point stops, by the Illinois rule on its speed: a straight line under
// constant forces, so that two attempts are enough. What solves leave of a speed cannot be told from none.
void Stepper::cutAtStop(double& tau, Segment& segment) {
  const auto none = [&](const Left& left) {
    return std::abs(left.share) < 1e-13 || std::abs(left.share) * left.speed < aim_ * island_.loadSpeed();
  };
  double low = 0.0, f_low = 1.0, high = tau, f_high = attempt(tau, Friction::KeepsDirection).slip_left.share;
  if (f_high >= 0.0) return;
  for (int k = 0; k < 12 && high - low > 1e-14 * tau; ++k) {
    const double middle = (low * f_high - high * f_low) / (f_high - f_low);
    const Left left = attempt(middle, Friction::KeepsDirection).slip_left;
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
  segment = attempt(tau, Friction::Free);
}

bool Stepper::run() {
  const std::vector<BodyMotion> start = island_.save();
  const IslandCertificate certified = islandCertificate();
  touching_ = find(now_);
  expectLastForces(step_.contacts, touching_);
  double turn = 0.0;
  const Bodies& bodies = context_.scene.bodies;
  for (const Index i : island_.indices())
    if (!std::holds_alternative<Sphere>(bodies.traits[i].shape))
      turn = std::max(turn, bodies.twist[i].w_WB.norm() * (end_ - now_));
  const double longest =
      (end_ - now_) / std::clamp(static_cast<int>(std::ceil(std::min(turn / kTurn, 1e6))), 1, kMostSegments);
  while (end_ - now_ > 1e-12 * step_.h()) {
    if (takeOverlapsAway()) {
      const Touching before = std::move(touching_);
      touching_ = find(now_);
      touching_.inherit(before);
    }
    settle();
    const double left = end_ - now_;
    double tau = left > 1.5 * longest ? longest : left;
    Segment segment = attempt(tau, Friction::Free);
    while (reach_ < kFarthest && segment.first.converged && overlooked(segment.touching)) {
      lookFarther();
      segment = attempt(tau, Friction::Free);
    }
    const int points = static_cast<int>(touching_.points.size() + touching_.couples.size());
    if (segment.slip_left.share <= 1e-9 && cuts_ >= points && !step_.isLate()) {
      cuts_ -= points;
      stops_.push_back(segment.slip_left.of);
      cutAtStop(tau, segment);
    }
    certify(segment.first);
    certify(segment.second);
    if (promoted_ && !islandCertificate().converged) {
      island_.restore(start);
      islandCertificate() = certified;
      return false;
    }
    island_.restore(segment.end);
    touching_ = std::move(segment.touching);
    now_ += tau;
    reach_ = 1.0;
  }
  return true;
}

void Stepper::store() {
  clock_.charge(kSolve);
  storeTouching(touching_, pairs_, step_.contacts);
  clock_.charge(kStore);
}

}  // namespace

bool advance(Context& context, const IslandBatch& batch, double t0, double t1) {
  if (!(t1 > t0)) return true;
  Stepper stepper(context, batch, t0, t1);
  if (!stepper.run()) return false;
  stepper.store();
  return true;
}

}  // namespace rbs::exact_step

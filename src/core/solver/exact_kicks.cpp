// SPDX-License-Identifier: BSD-3-Clause
// The impulses of a segment: what its two kicks solve, how far their answers are from the law, and what one
// kick expects of the next.
#include "solver/exact_stepper.h"

#include "base/algebra.h"
#include "solver/residuals.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rbs::exact_step {

namespace {

// Share of the smaller length of a pair: curvature beyond it is given back to the first kick.
constexpr double kCurved = 1e-10;
// A share of the speed at which points move that is no closing.
constexpr double kNoClosing = 1e-9;
// Forces that change by less than this many times what solves aim at are nearly as expected.
constexpr double kNoChange = 1e3;
// A point that overlaps by more than this share of the length was put there by an edit. How its gap curves
// tells nothing: its normal jumps from face to face, and the speed that would undo the jump is no speed of a
// body.
constexpr double kEditOverlap = 1e-2;

// Share of the smaller length up to which an overlap is the rounding of a time of impact.
constexpr double kJustBefore = 1e-9;

// Cosine of the turn of a normal from which it is another one, of which the slip tells nothing.
constexpr double kSameWay = 0.95;

const char* nameOf(CoulombSolver solver) {
  switch (solver) {
    case CoulombSolver::WarmStart:
      return "warm_start";
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

// Whether a point meets at the end of the step, and will rebound: the impact is found at the start of the next one.
bool comesToRebound(const TouchingPoint& point, double u_n) {
  const bool has_pushed = !point.force_W.isZero(0.0) || !point.impulse_W.isZero(0.0);
  return point.gap > -kJustBefore * point.length && !has_pushed && u_n < -point.rebounds_from;
}

// A direction in the plane of one contact frame, as a direction in the plane of another.
Vec2 inPlaneOf(const Mat3& frame, const Mat3& known_frame, const Vec2& direction) {
  const Mat3 turn = frame.transpose() * known_frame;
  return (turn.topLeftCorner<2, 2>() * direction).normalized();
}

// Adds an impulse on the second side of a point, and its opposite on the first.
void push(CoulombBodies& bodies, const CoulombPoint& law, const Vec3& impulse_W) {
  const auto give = [&](Index body, const Vec3& arm, const Vec3& part_W) {
    if (body == kNone) return;
    CoulombBody& b = bodies[body];
    const Vec3 n_W = law.frame.col(2);
    b.v += part_W / b.mass;
    const Vec3 about_axis_W = momentAbout(law.axis_W, arm, n_W) * n_W.dot(part_W) * law.axis_W;
    if (b.turns) b.w += b.inertia_W.llt().solve(arm.cross(part_W) - about_axis_W);
  };
  give(law.i, law.r_i, -impulse_W);
  give(law.j, law.r_j, impulse_W);
}

// The fastest of the points of a problem, on either side, m/s.
double fastestOf(const CoulombProblem& problem) {
  double fastest = 0.0;
  for (const CoulombPoint& law : problem.points)
    for (const auto& [body, arm] : {std::pair(law.i, law.r_i), std::pair(law.j, law.r_j)})
      if (body != kNone)
        fastest = std::max(fastest, (problem.bodies[body].v + problem.bodies[body].w.cross(arm)).norm());
  return fastest;
}

}  // namespace

// Residuals are measured against what the load does in a step, or the fastest closing where that is more. What is no more
// than the rounding of how fast the points move is no closing.
//
// What the solve before a drift of `tau` leaves grows to a gap of tau times that. It need be no less than kCurved: the
// curvature is not known to more digits, and in what is beyond them four corners of a face ask for what no motion of it has.
CoulombResult Stepper::solveKick(CoulombProblem& problem, double tau) {
  problem.speed_unit = std::max(island_.loadSpeed(), kNoClosing * fastestOf(problem));
  for (const CoulombPoint& law : problem.points)
    problem.speed_unit = std::max(problem.speed_unit, -velocityAt(problem.bodies, law)[2]);
  if (!(problem.speed_unit > 0.0)) {
    for (CoulombPoint& law : problem.points) law.impulse.setZero();
    for (TorqueConstraint& law : problem.torques) law.impulse.setZero();
    return {CoulombSolver::WarmStart, 0, 0.0, 0.0, 0.0, true};
  }
  double needed = tolerance_;
  if (tau > 0.0) {
    double length = std::numeric_limits<double>::infinity();
    for (const TouchingPoint& point : touching_.points) length = std::min(length, point.length);
    needed = std::max(needed, std::min(kCurved * length / (tau * problem.speed_unit), kCoarsest));
  }
  const CoulombResult result = solveInBudget(problem, tolerance_, wanted_tolerance_, needed);
  island().residuals.iterations += static_cast<std::uint32_t>(result.iterations);
  return result;
}

// A solve that does not converge takes at most a quarter of the budget, what others have taken of it included: the bound must
// not depend on them.
CoulombResult Stepper::solveInBudget(CoulombProblem& problem, double tolerance, double wanted,
                                     double needed) {
  const std::int64_t most = std::max(budget_.left / 4, whole_budget_ / 64);
  const SolveBudget part{std::min(budget_.left - budget_.reserved, most), budget_.until};
  SolveBudget left = part;
  problem.budget = &left;
  const CoulombResult result = solveCoulomb(problem, tolerance, wanted, needed);
  budget_.left -= part.left - left.left;
  if (!result.converged && left.left <= 0) island().cut_short = true;
  return result;
}

// Of a solve that counts: trials that are given up cost iterations and say nothing of the result.
void Stepper::addResiduals(const CoulombResult& result) {
  IslandResiduals solved;
  solved.method = nameOf(result.solver);
  solved.signorini = result.signorini;
  solved.coulomb = result.coulomb;
  solved.dissipation = result.dissipation;
  solved.converged = result.converged;
  residuals::add(island().residuals, solved);
  residuals::add(own_, solved);
}

// Makes velocities obey the law at this instant, under `seconds` of the forces that are expected; 0 for an
// impact without restitution.
CoulombResult Stepper::kickAtInstant(TouchingPoints& touching, CoulombBodies& bodies, double seconds,
                                     Friction friction) {
  CoulombProblem problem{bodies, {}, 0.0};
  problem.points.reserve(touching.points.size());
  std::vector<std::size_t> closed;
  closed.reserve(touching.points.size());
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    const TouchingPoint& point = touching.points[k];
    const bool pushed = seconds > 0.0 && !point.force_W.isZero(0.0);
    if (point.gap > (pushed ? kPushedGap : kTouch) * point.length) continue;
    if (comesToRebound(point, velocityAt(bodies, touching.law[k])[2])) continue;
    closed.push_back(k);
    problem.points.push_back(touching.law[k]);
    problem.points.back().impulse = seconds * (touching.law[k].frame.transpose() * point.force_W);
    giveWay(point, seconds > 0.0 ? 2.0 * seconds : end_ - now_, seconds == 0.0, problem.points.back());
  }
  std::vector<std::size_t> borne;
  for (std::size_t k = 0; k < touching.torques.size(); ++k) {
    const TouchingTorque& torque = touching.torques[k];
    const auto place = [&](Index point) {
      return static_cast<Index>(std::lower_bound(closed.begin(), closed.end(), point) - closed.begin());
    };
    TorqueConstraint law = torque.law;
    law.first = place(torque.law.first);
    law.size = place(torque.law.first + torque.law.size) - law.first;
    if (law.size == 0) continue;
    law.impulse = seconds * (law.frame.transpose() * torque.force_W);
    borne.push_back(k);
    problem.torques.push_back(law);
  }
  CoulombResult result = solveKick(problem, 0.0);
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
      for (TorqueConstraint& law : problem.torques) {
        const Vec3 u = turningAt(problem.bodies, law);
        if (!law.rolls.isZero(0.0) && !(result.converged && law.rolls.dot(u.head<2>()) >= 0.0))
          law.rolls.setZero(), fixed = true;
        if (law.spins != 0.0 && !(result.converged && law.spins * u[2] >= 0.0)) law.spins = 0.0, fixed = true;
      }
      if (!fixed) break;
      problem.bodies = bodies;
      result = solveKick(problem, 0.0);
    }
  }
  bodies = problem.bodies;
  for (std::size_t k = 0; k < closed.size(); ++k) {
    CoulombPoint& law = touching.law[closed[k]];
    law.impulse = problem.points[k].impulse, law.slide = problem.points[k].slide;
  }
  for (std::size_t k = 0; k < borne.size(); ++k)
    touching.torques[borne[k]].law.impulse = problem.torques[k].impulse;
  return result;
}

void Stepper::solveVelocities() {
  CoulombBodies after = island_.bodies();
  TouchingPoints touching = touching_;
  addResiduals(kickAtInstant(touching, after, 0.0, Friction::Free));
  island_.setTwists(after);
  for (std::size_t k = 0; k < touching_.points.size(); ++k)
    touching_.points[k].impulse_W += touching.law[k].frame * touching.law[k].impulse;
}

// What the drift has added to the gaps beyond tau u_n, and to the slip of points that were held at the start
// beyond tau u_T; and whether that is more than the kick allowed for.
bool Stepper::updateCurvature(const CoulombBodies& drifting, const std::vector<CoulombPoint>& laws,
                              const std::vector<char>& held, const std::vector<BodyMotion>& start,
                              const TouchingPoints& later, double tau, std::vector<Vec3>& curvature) const {
  bool matters = false;
  const std::vector<BodyMotion> end = island_.save();
  const CoulombBodies drifted = island_.bodies();
  for (std::size_t k = 0; k < curvature.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    const Index m = later.matching(point);
    if (m == kNone || point.gap < -kEditOverlap * point.length) continue;
    const CoulombPoint &law = touching_.law[k], &law_later = later.law[m];
    if (isElsewhere(takenBack(later.points[m], law_later, start, end, tau), point)) continue;
    const double same_way = law.frame.col(2).dot(law_later.frame.col(2));
    if (same_way <= 0.0) continue;  // it went through, and is open on the other side
    const Vec3 u = velocityAt(drifting, law);
    const Vec3 u_later = law.frame.transpose() * (law_later.frame * velocityAt(drifted, law_later));
    Vec3 c = 0.5 * tau * (u_later - u);
    if (!held[k] || same_way < kSameWay) c.setZero();
    c[2] = later.points[m].gap - point.gap - tau * u[2];
    const double enough = kCurved * point.length;
    const bool pushes = laws[k].impulse[2] > 0.0;
    matters = matters || ((pushes || later.points[m].gap < 0.0) && std::abs(c[2] - curvature[k][2]) > enough);
    matters = matters || (pushes && (c - curvature[k]).head<2>().norm() > enough);
    curvature[k] = c;
  }
  return matters;
}

// Whether impulses are nearly those of the forces expected.
bool Stepper::areAsExpected(const TouchingPoints& touching, const std::vector<CoulombPoint>& laws,
                            double seconds) const {
  double change = 0.0;
  for (std::size_t k = 0; k < laws.size(); ++k)
    change =
        std::max(change, (laws[k].frame * laws[k].impulse - seconds * touching.points[k].force_W).norm());
  return change <= kNoChange * wanted_tolerance_ * island_.mass() * island_.loadSpeed();
}

// How much of what a solve has mended is to be expected of the next kicks as well: 1 where bodies move. Near
// rest a solve mends two things: what the forces expected are wrong by, and what earlier kicks have left, of
// speed or of a gap, because their warm starts were right enough to pass. Were all of it expected again, the next
// kick would overdo it, and the one after that undo it, for ever; were none, forces that are a little wrong
// would have to be mended for ever. With u the velocities of the points that push, along their normals and,
// where they stick, across, at the start of the kick, by the warm start, and as solved, the forces are wrong by what
// the warm start did to them, and all is mended that the solve does to it:
//   share = sum (u_warm - u_start).(u_warm - u_solved) / sum |u_warm - u_solved|^2,
// which is exact where the two are in proportion, as after any number of equal kicks.
double Stepper::lastingShare(const CoulombResult& result, const TouchingPoints& touching,
                             const std::vector<CoulombPoint>& laws, double seconds,
                             const CoulombBodies& start, const CoulombBodies& solved) const {
  if (!areAsExpected(touching, laws, seconds)) return 1.0;
  if (result.solver == CoulombSolver::WarmStart) return 0.0;
  CoulombBodies warm = solved;
  for (std::size_t k = 0; k < laws.size(); ++k)
    push(warm, laws[k], seconds * touching.points[k].force_W - laws[k].frame * laws[k].impulse);
  double wrong = 0.0, mended = 0.0;
  for (const CoulombPoint& law : laws) {
    if (!(law.impulse[2] > 0.0)) continue;
    const double sticks = isWithinCone(law.impulse, law.mu) ? 1.0 : 0.0;
    const Vec3 seen(sticks, sticks, 1.0);
    const Vec3 u_warm = velocityAt(warm, law).cwiseProduct(seen);
    const Vec3 mend = u_warm - velocityAt(solved, law).cwiseProduct(seen);
    wrong += mend.dot(u_warm - velocityAt(start, law).cwiseProduct(seen));
    mended += mend.squaredNorm();
  }
  return mended > 0.0 ? std::clamp(wrong / mended, 0.0, 1.0) : 0.0;
}

// Hands the forces of the first kick on as what is expected of the second, with the directions of sliding.
void Stepper::expectSecondKick(const CoulombProblem& kick, double lasting, double tau, Friction friction,
                               Segment& segment) const {
  TouchingPoints& later = segment.touching;
  const CoulombBodies drifted = island_.bodies();
  for (std::size_t k = 0; k < kick.points.size(); ++k) {
    const CoulombPoint& law = kick.points[k];
    const Index m = later.matching(touching_.points[k]);
    const Vec3 impulse_W = law.frame * law.impulse;
    TouchingPoint point = touching_.points[k];
    point.impulse_W += impulse_W;
    if (m == kNone) {
      if (!point.impulse_W.isZero(0.0))
        segment.opened.emplace_back(point.contact, openedPoint(point, law.frame.col(2)));
      continue;
    }
    later.points[m].force_W = expectedNext(point.force_W, 2.0 / tau * impulse_W, lasting);
    later.points[m].impulse_W = point.impulse_W;
    const Vec2 u_T = velocityAt(kick.bodies, law).head<2>();
    const bool slides = friction == Friction::KeepsDirection ? !law.slide.isZero(0.0) : u_T.norm() > slow_;
    if (law.mu == 0.0 || !(law.impulse[2] > 0.0) || !slides) continue;
    const Vec2 ahead = velocityAt(drifted, later.law[m]).head<2>();
    const bool keeps = friction == Friction::KeepsDirection;
    if (keeps && ahead.norm() <= slow_) {
      // It stops in the middle of the segment: the speed there has no direction.
      later.law[m].slide = inPlaneOf(later.law[m].frame, law.frame, law.slide);
    } else if (!ahead.isZero(0.0)) {
      later.law[m].slide = ahead.normalized();
      if (keeps && u_T.dot(law.slide) < 0.0) later.law[m].slide *= -1.0;
    }
  }
  expectTorques(kick, drifted, tau, friction, later);
}

void Stepper::expectTorques(const CoulombProblem& kick, const CoulombBodies& drifted, double tau,
                            Friction friction, TouchingPoints& later) const {
  for (std::size_t k = 0; k < kick.torques.size(); ++k) {
    const TorqueConstraint& law = kick.torques[k];
    const Index m = later.matching(touching_.torques[k]);
    if (m == kNone) continue;
    later.torques[m].force_W = 2.0 / tau * (law.frame * law.impulse);
    double n = 0.0;
    for (Index p = law.first; p < law.first + law.size; ++p) n += kick.points[p].impulse[2];
    if (!(n > 0.0)) continue;
    TorqueConstraint& aimed = later.torques[m].law;
    const Vec3 u = turningOf(kick.bodies, law), ahead = turningAt(drifted, aimed);
    const bool keeps = friction == Friction::KeepsDirection;
    if (keeps && ahead.head<2>().norm() <= slow_) {
      aimed.rolls = inPlaneOf(aimed.frame, law.frame, law.rolls);
    } else if (keeps ? !law.rolls.isZero(0.0) : !u.head<2>().isZero(0.0)) {
      aimed.rolls = ahead.head<2>().normalized();
      if (keeps && u.head<2>().dot(law.rolls) < 0.0) aimed.rolls *= -1.0;
    }
    if (keeps && std::abs(ahead[2]) <= slow_) {
      aimed.spins = law.spins;
    } else if (keeps ? law.spins != 0.0 : u[2] != 0.0) {
      aimed.spins = std::copysign(1.0, ahead[2]);
      if (keeps && u[2] * law.spins < 0.0) aimed.spins *= -1.0;
    }
  }
}

}  // namespace rbs::exact_step

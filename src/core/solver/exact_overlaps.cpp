// SPDX-License-Identifier: BSD-3-Clause
// Overlaps, taken away by a displacement before the velocities are solved for, so that they add no speed.
#include "solver/exact_stepper.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <map>

namespace rbs::exact_step {

namespace {

// Share of the smaller length of a pair: an overlap beyond it is taken away, if it is more than what so many kicks leave that
// are right to ten times the wanted tolerance, or than a share of what trips a body at a joint.
constexpr double kOverlap = 1e-11, kKicks = 10.0, kOfTouch = 0.5;
// Share of it up to which an overlap may be taken away at any time: drifts leave such.
constexpr double kSmall = 1e-4;
// Of all overlaps together: the longest displacement that is a way out of them.
constexpr double kNarrowest = 50.0;

}  // namespace

// Whether a displacement is a way out of overlaps. What two that nothing moves overlap has no place between them, or leaves them
// along a wedge so narrow that friction would hold it there: the impulses of such a problem, and with them the displacement,
// grow without end.
bool Stepper::isWayOut(const CoulombProblem& problem) const {
  double asked = 0.0;
  for (const CoulombPoint& law : problem.points) asked += std::max(-law.bias[2], 0.0);
  const std::vector<Traits>& traits = context_.scene.bodies.traits;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const CoulombBody& body = problem.bodies[k];
    const double reach = traits[island_.indices()[k]].bounding_radius;
    if (!(body.v.norm() + reach * body.w.norm() <= kNarrowest * asked)) return false;
  }
  return true;
}

// By a displacement d: M d = J^T l, 0 <= l, 0 <= J d + gap, their product zero. The same law, without
// friction and with lengths for velocities.
bool Stepper::correctOverlaps() {
  squeezed_.clear();
  const double left_by_kicks = kKicks * 10.0 * wanted_tolerance_ * island_.loadSpeed() * step_.h();
  // What a pair may be parted by until the end of the next segment, without what it has been: that may have been for longer than
  // its segment was in the end.
  const double seconds = now_ + nextLength() - (end_ - span_);
  const auto mostOf = [&](const TouchingPoint& point) {
    const auto parted = parted_.find(point.contact);
    return point.push * seconds - (parted == parted_.end() ? 0.0 : parted->second);
  };
  CoulombProblem problem{island_.bodies(), touching_.law, 0.0};
  for (CoulombBody& body : problem.bodies) body.v.setZero(), body.w.setZero();
  for (std::size_t k = 0; k < touching_.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    CoulombPoint& law = problem.points[k];
    law.mu = 0.0;
    law.bias = Vec3(0.0, 0.0, std::max(point.gap, -std::max(mostOf(point), kSmall * point.length)));
    const double left = std::min(left_by_kicks, kOfTouch * kTouch * point.length);
    if (point.gap < -std::max(kOverlap * point.length, left))
      problem.speed_unit = std::max(problem.speed_unit, -law.bias[2]);
  }
  if (problem.speed_unit == 0.0) return false;
  const bool yields = letYield(problem);
  solveInBudget(problem, kCoarsest, kCoarsest, kCoarsest);
  if (yields && !isShort(problem)) {
    for (CoulombBody& body : problem.bodies) body.v.setZero(), body.w.setZero();
    for (std::size_t k = 0; k < touching_.points.size(); ++k)
      problem.points[k].mu = touching_.law[k].mu, problem.points[k].impulse.setZero();
    solveInBudget(problem, kCoarsest, kCoarsest, kCoarsest);
  }
  if (!findSqueezed(problem)) giveUp(Outcome::NoSolution);
  if (!isGoing() || !isWayOut(problem)) return false;
  leaveSqueezed(problem);
  island_.displace(problem.bodies);
  std::map<Index, double> parted;
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    double& by = parted[touching_.points[k].contact];
    by = std::max(by, -problem.points[k].bias[2]);
  }
  for (const auto& [contact, by] : parted) parted_[contact] += by;
  giveAngularMomentumBack(problem);
  return true;
}

// What the shift by l n at a point makes of the angular momentum of its two bodies, l n x (v_j - v_i), they give back by their
// spin.
void Stepper::giveAngularMomentumBack(const CoulombProblem& displaced) {
  CoulombBodies bodies = island_.bodies();
  const CoulombBodies before = bodies;
  // The projection on the spins that contacts with such friction can change.
  const auto turnable = [&](Index slot, double mu) -> Mat3 {
    const Index body = island_.indices()[slot];
    if (!before[slot].turns) return Mat3::Zero();
    if (mu > 0.0) return Mat3::Identity();
    if (context_.scene.bodies.traits[body].round) return Mat3::Zero();
    const Vec3 axis_W = context_.scene.bodies.axis_W(body);
    return Mat3::Identity() - axis_W * axis_W.transpose();
  };
  for (std::size_t k = 0; k < displaced.points.size(); ++k) {
    const CoulombPoint& law = displaced.points[k];
    if (law.i == kNone || law.j == kNone) continue;
    const Vec3 shift_W = law.impulse[2] * law.frame.col(2);
    const Vec3 slip_W = before[law.j].v - before[law.i].v, half_W = 0.5 * shift_W.cross(slip_W);
    CoulombBody &i = bodies[law.i], &j = bodies[law.j];
    const double most = slip_W.squaredNorm() / (1.0 / i.mass + 1.0 / j.mass);
    if (touching_.law[k].mu > 0.0 && i.turns && j.turns) {
      const Vec3 turn_i_W = i.inertia_W.llt().solve(half_W), turn_j_W = j.inertia_W.llt().solve(half_W);
      if (half_W.dot(turn_i_W) + half_W.dot(turn_j_W) <= most) {
        i.w -= turn_i_W, j.w -= turn_j_W;
        continue;
      }
    }
    // In halves, unless that takes more energy than the two have against each other, or friction would have to turn them: then by
    // one turn of both, which takes the least: half of it may be far too much for a small ball.
    const Mat3 P_i = turnable(law.i, touching_.law[k].mu), P_j = turnable(law.j, touching_.law[k].mu);
    const Mat3 inertia_W = P_i * i.inertia_W * P_i + P_j * j.inertia_W * P_j;
    Vec3 turn_W = inertia_W.completeOrthogonalDecomposition().solve(2.0 * half_W);
    // Two small ones between two heavy ones do not have so much either, and take what they have.
    const double taken = 2.0 * half_W.dot(turn_W);
    if (taken > most) turn_W *= std::sqrt(most / taken);
    i.w -= P_i * turn_W, j.w -= P_j * turn_W;
  }
  island_.setTwists(bodies);
}

}  // namespace rbs::exact_step

// SPDX-License-Identifier: BSD-3-Clause
// What is squeezed: bodies that overlap others which no force moves, and that no displacement frees, as what two kinematic
// fingers hold.
//
// Rigid bodies have no answer to it. While the fingers close, no velocity keeps u_n >= 0 on both sides. Once they stand, any
// force along their normals is a solution, none among them, with which the body falls. A solid has one: it bears k d where it is
// pressed together by d. So the points of squeezed bodies give way, by their overlaps. Of the material nothing is known. k is
// such that an overlap of kOwnWeight of the length L bears the load a of the body, its weight:
//   k = m a / (kOwnWeight L).
// The impulse of half a segment is that force at its end, r = tau/2 k (d - tau u_n), or
//   u_n + g r - d / tau = 0,   g = 2 / (k tau^2),
// which is what CoulombPoint takes: g for `give`, and -d / tau for its bias. In the kick at the end of the drift the same is a
// spring with a strong damper. Only points on what forces do not move give way: what is between two bodies of a squeezed stack
// follows from these.
#include "solver/exact_stepper.h"

#include <algorithm>
#include <cmath>

namespace rbs::exact_step {

namespace {

// Share of the smaller length of a pair: rubber gives way by 1e-2 of a metre under the weight of a metre, wood by 1e-6.
constexpr double kOwnWeight = 2e-5;
// Share of that length up to which an overlap is what kicks leave.
constexpr double kLeftByKicks = 1e-6;
// Cosine of the angle between two normals that may squeeze.
constexpr double kFacing = -0.3;
// Where overlaps are taken away, points give way by this share of what the body alone would move by.
constexpr double kYields = 1e-9;
// A displacement is short up to so many times the overlaps, the deepest of each pair.
constexpr double kDirect = 3.0;
// Share of its overlap that is left at a point of a squeezed body, and much more than kYields leaves of others.
constexpr double kUnfreed = 0.1;
// Share of the smaller length of a pair by which something may be squeezed.
constexpr double kMostSqueezed = 0.1;
// Shares of that length: by which a step must squeeze it further to count, and by which it may.
constexpr double kFurther = 1e-7, kFast = 0.02;

bool bearsOnUnmoved(const CoulombPoint& law) {
  return law.i == kNone || law.j == kNone;
}

Index bodyOf(const CoulombPoint& law) {
  return law.i == kNone ? law.j : law.i;
}

// From what forces do not move into the body.
Vec3 pressingNormal(const CoulombPoint& law) {
  return (law.i == kNone ? 1.0 : -1.0) * law.frame.col(2);
}

bool facesAny(const Vec3& n_W, const std::vector<Vec3>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Vec3& other) { return n_W.dot(other) < kFacing; });
}

}  // namespace

// Before overlaps are taken away, so that there is a displacement even where it frees nothing. Returns whether that is possible:
// two of the normals that press are more than a right angle apart. The normals of two fingers are 180 degrees apart, of three
// 120, of four around a ball 109.
bool Stepper::letYield(CoulombProblem& problem) const {
  double deepest = 0.0, share = 0.0;
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    if (!bearsOnUnmoved(problem.points[k])) continue;
    deepest = std::max(deepest, -point.gap), share = std::max(share, -point.gap / point.length);
  }
  if (share <= kLeftByKicks) return false;
  std::vector<Vec3> normals;  // of all that a displacement by that may reach
  for (std::size_t k = 0; k < problem.points.size(); ++k)
    if (bearsOnUnmoved(problem.points[k]) && touching_.points[k].gap < deepest)
      normals.push_back(pressingNormal(problem.points[k]));
  if (std::none_of(normals.begin(), normals.end(), [&](const Vec3& n) { return facesAny(n, normals); }))
    return false;
  for (std::size_t k = 0; k < problem.points.size(); ++k)
    if (CoulombPoint& law = problem.points[k]; bearsOnUnmoved(law) && touching_.points[k].gap < 0.0)
      law.give = kYields / problem.bodies[bodyOf(law)].mass;
  return true;
}

// Whether a displacement is about as long as the overlaps that it takes away. Along a narrow wedge it is longer, and friction
// holds what is in the wedge.
bool Stepper::isShort(const CoulombProblem& problem) const {
  double asked = 0.0;
  for (std::size_t k = 0; k < problem.points.size();) {
    double deepest = 0.0;
    for (const Index contact = touching_.points[k].contact;
         k < problem.points.size() && touching_.points[k].contact == contact; ++k)
      deepest = std::max(deepest, -problem.points[k].bias[2]);
    asked += deepest;
  }
  return std::all_of(problem.bodies.begin(), problem.bodies.end(),
                     [&](const CoulombBody& body) { return body.v.norm() <= kDirect * asked; });
}

// Afterwards: finds the contacts that squeeze, and those of the same bodies that face them. False where an overlap is more than
// kMostSqueezed.
bool Stepper::findSqueezed(const CoulombProblem& problem) {
  squeezed_.clear();
  std::vector<Vec3> normals;
  std::vector<char> squeezed(problem.bodies.size());
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    const CoulombPoint& law = problem.points[k];
    if (law.give == 0.0 || law.give * law.impulse[2] < kUnfreed * -law.bias[2]) continue;
    if (-point.gap > kMostSqueezed * point.length) return false;
    normals.push_back(pressingNormal(law));
    squeezed[bodyOf(law)] = true;
    squeezed_.push_back(point.contact);
  }
  if (normals.empty()) return true;
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const CoulombPoint& law = problem.points[k];
    if (bearsOnUnmoved(law) && squeezed[bodyOf(law)] && facesAny(pressingNormal(law), normals))
      squeezed_.push_back(touching_.points[k].contact);
  }
  std::sort(squeezed_.begin(), squeezed_.end());
  squeezed_.erase(std::unique(squeezed_.begin(), squeezed_.end()), squeezed_.end());
  return true;
}

// Squeezed bodies take no part in a displacement: they go where their forces push them.
void Stepper::leaveSqueezed(CoulombProblem& problem) const {
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    if (!isSqueezed(touching_.points[k])) continue;
    CoulombBody& body = problem.bodies[bodyOf(problem.points[k])];
    body.v.setZero(), body.w.setZero();
  }
}

bool Stepper::isSqueezed(const TouchingPoint& point) const {
  return std::binary_search(squeezed_.begin(), squeezed_.end(), point.contact);
}

// k of the point of a squeezed body. Its push is sqrt(a L).
double Stepper::stiffnessOf(const TouchingPoint& point, const CoulombPoint& law) const {
  const Index body = island_.indices()[bodyOf(law)];
  const double share = point.push / point.length;
  return context_.scene.bodies.traits[body].mass * share * share / kOwnWeight;
}

// What squeezed bodies hold now, J.
double Stepper::elasticEnergy() const {
  double energy = 0.0;
  for (std::size_t k = 0; k < touching_.points.size(); ++k) {
    const TouchingPoint& point = touching_.points[k];
    if (point.gap < 0.0 && isSqueezed(point))
      energy += 0.5 * stiffnessOf(point, touching_.law[k]) * point.gap * point.gap;
  }
  return energy;
}

// Lets the point of a squeezed body give way in a segment of `tau`. At an instant it is a damper alone.
void Stepper::giveWay(const TouchingPoint& point, double tau, bool at_instant, CoulombPoint& law) const {
  if (!isSqueezed(point)) return;
  law.give = 2.0 / (stiffnessOf(point, law) * tau * tau);
  if (at_instant || point.gap >= 0.0) return;
  const double push = std::min(-point.gap / tau, point.push);
  law.bias[2] -= push;
  if (law.impulse.isZero(0.0)) law.impulse[2] = push / law.give;
}

// What squeezed points bear says nothing to another method, whose contacts have another stiffness.
void Stepper::forgetSqueezed() {
  for (const Index k : squeezed_)
    for (SolvedPoint& point : context_.scene.contacts.active[k].points)
      point.normal = 0.0, point.friction_W.setZero();
}

// By how much something is squeezed further in a step at this instant, a share of its length.
double Stepper::squeezingOf(const TouchingPoints& touching, const CoulombBodies& bodies) const {
  double most = 0.0;
  for (std::size_t k = 0; k < touching.points.size(); ++k) {
    const TouchingPoint& point = touching.points[k];
    if (isSqueezed(point))
      most = std::max(most, -velocityAt(bodies, touching.law[k])[2] * span_ / point.length);
  }
  return most;
}

// Reports what a segment has squeezed further, for which a rigid body leaves no room. The law above is for slow squeezing: fast
// squeezing is left to the soft step.
void Stepper::judgeSqueezing() {
  if (segment_.squeezing <= kFurther) return;
  if (segment_.squeezing > kFast) return giveUp(Outcome::NoSolution);
  outcome_ = Outcome::NoRoom;
  own_.converged = island().residuals.converged = false;
}

}  // namespace rbs::exact_step

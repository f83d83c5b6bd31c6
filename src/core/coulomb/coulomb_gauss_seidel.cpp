// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/cone.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbs::coulomb {

namespace {

constexpr std::size_t kMostPoints = 4;
constexpr int kLeastSweeps = 10;  // also where time is over
// Multiplications by point or torque in a sweep, with its residuals.
constexpr std::int64_t kSweepWork = 500;

// The impulse of one point, W being its own block of J J^T and q its velocity without an impulse of its own.
Vec3 solvePoint(const Point& point, const Mat3& W, const Vec3& q) {
  const FrictionSet<2>& sliding = point.sliding;
  if (!sliding.slips) return solveContact(W, q, sliding.factor);
  // Friction is known but for its size: u_n = W_n (1, -mu slide) r_n + q_n.
  const Vec3 along(-sliding.factor * sliding.slip[0], -sliding.factor * sliding.slip[1], 1.0);
  const double response = W.row(2).dot(along);
  if (q[2] >= 0.0 || response <= 0.0) return Vec3::Zero();
  return -q[2] / response * along;
}

// A step towards the law of one torque under the normal impulses of its points: its own block is nearly a
// multiple of the identity.
Vec3 improveTorque(const TorqueRows& torque, const Vec3& old, const Vec3& u, const Impulses& r) {
  const double most = 3.0 * torque.response;  // more than the largest eigenvalue
  return System::nearest(torque, old - u / most, System::normalSum(torque, r));
}

// The rows of a joint, each solved exactly in turn.
void solveJoint(const JointRows& joint, Vec3& r, Velocities& y, const System& system) {
  for (int c = 0; c < 3; ++c) {
    const double response = joint.J_i.row(c).squaredNorm() + joint.J_j.row(c).squaredNorm();
    if (response == 0.0) continue;
    const double u = system.velocity(joint, y)[c];
    Vec3 change = Vec3::Zero();
    change[c] = std::clamp(r[c] - u / response, joint.box.lo[c], joint.box.hi[c]) - r[c];
    r += change;
    System::push(joint, change, y);
  }
}

}  // namespace

bool separable(const System& system) {
  if (system.points().size() > kMostPoints || system.columns() > system.points().size()) return false;
  const Index bodies = static_cast<Index>(system.free().cols());
  std::vector<Index> group(bodies + 1);  // the last: all that impulses do not move
  std::iota(group.begin(), group.end(), 0);
  for (const Point& point : system.points()) {
    const Index a = group[std::min(point.i, bodies)], b = group[std::min(point.j, bodies)];
    if (a == b) return false;
    std::replace(group.begin(), group.end(), a, b);
  }
  return true;
}

Answer gaussSeidel(const System& system, double tolerance, int cap) {
  const std::vector<Point>& points = system.points();
  std::vector<Mat3> W;
  for (const Point& point : points) {
    W.push_back(point.J_i * point.J_i.transpose() + point.J_j * point.J_j.transpose());
  }
  Answer answer;
  answer.r = system.noImpulses();
  Velocities y = system.free();
  system.push(answer.r, y);
  while (answer.iterations < cap) {
    ++answer.iterations;
    system.spend(kSweepWork * static_cast<std::int64_t>(system.columns()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 old = answer.r.col(k);
      const Vec3 q = system.velocity(points[k], y) - W[k] * old;
      answer.r.col(k) = solvePoint(points[k], W[k], q);
      System::push(points[k], answer.r.col(k) - old, y);
    }
    for (std::size_t k = 0; k < system.torques().size(); ++k) {
      const TorqueRows& torque = system.torques()[k];
      const Vec3 old = answer.r.col(points.size() + k);
      answer.r.col(points.size() + k) = improveTorque(torque, old, system.velocity(torque, y), answer.r);
      System::push(torque, answer.r.col(points.size() + k) - old, y);
    }
    for (std::size_t k = 0; k < system.joints().size(); ++k) {
      Vec3 r = answer.r.col(system.firstJoint() + k);
      solveJoint(system.joints()[k], r, y, system);
      answer.r.col(system.firstJoint() + k) = r;
    }
    answer.residuals = system.residuals(answer.r);
    if (answer.within(tolerance) || (answer.iterations >= kLeastSweeps && system.isBudgetSpent())) break;
  }
  return answer;
}

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
// The Coulomb problem of an island without units, as its solvers see it.
//
// Mass is measured in the mass of all bodies, speed in CoulombProblem::speed_unit. A body moves by
// y = (sqrt(m) v, L^T w), where m is its mass and L L^T its inertia, so that the mass matrix is the identity,
// the norm of y is that of kinetic energy, and no length is needed as a unit:
//   y = y_free + J^T r,   u = J y + bias.
#pragma once

#include "coulomb/box_set.h"
#include "coulomb/coulomb_problem.h"
#include "coulomb/friction_set.h"

#include <vector>

namespace rbs::coulomb {

using Vec2 = Eigen::Vector2d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat36 = Eigen::Matrix<double, 3, 6>;
using Impulses = Eigen::Matrix<double, 3, Eigen::Dynamic>;    ///< r, a column a point: two tangents and the
                                                              ///< normal; then one a torque, then one a joint
using Velocities = Eigen::Matrix<double, 6, Eigen::Dynamic>;  ///< y, a column a body

/// The rows of J of a point, a torque or a joint.
struct Rows {
  Index i, j;      ///< bodies; kNone: a side that impulses do not move
  Mat36 J_i, J_j;  ///< u changes by J_i y_i + J_j y_j; zero where there is no body
  Vec3 bias;
  double response;  ///< mean eigenvalue of their own block of J J^T: speed for an impulse
};

struct Point : Rows {
  FrictionSet<2> sliding;  ///< under its own normal impulse
};

/// Its velocity is that of turning times its length, so that it has the units of a point.
struct TorqueRows : Rows {
  std::size_t first, size;  ///< its points
  FrictionSet<2> rolling;   ///< under the sum of their normal impulses
  FrictionSet<1> spinning;  ///< under the same sum
};

struct JointRows : Rows {
  BoxSet box;
};

/// How far impulses are from the law; the greatest over points, torques and joints. See CoulombResult.
struct Residuals {
  double signorini = 0.0, coulomb = 0.0, dissipation = 0.0;
  /// The largest of the three, where each point is forgiven what the rounding of its own velocity amounts to.
  double beyond_rounding = 0.0;
  double worst() const { return std::max(signorini, std::max(coulomb, dissipation)); }
};

class System {
 public:
  explicit System(const CoulombProblem& problem);

  const std::vector<Point>& points() const { return points_; }
  const std::vector<TorqueRows>& torques() const { return torques_; }
  const std::vector<JointRows>& joints() const { return joints_; }
  const Velocities& free() const { return free_; }  ///< y_free
  std::size_t bodies() const { return responses_.size(); }
  /// Of a body; that of all is 1.
  double massOf(std::size_t i) const { return 1.0 / (responses_[i].linear * responses_[i].linear); }
  bool turns() const { return body_turns_; }                                   ///< impulses turn a body
  std::size_t columns() const { return firstJoint() + joints_.size(); }        ///< of impulses
  std::size_t firstJoint() const { return points_.size() + torques_.size(); }  ///< its column
  const Rows& rows(std::size_t k) const {                                      ///< of a column of impulses
    if (k < points_.size()) return points_[k];
    return k < firstJoint() ? static_cast<const Rows&>(torques_[k - points_.size()])
                            : joints_[k - firstJoint()];
  }

  /// u + J dy.
  static Vec3 changed(const Rows& rows, Vec3 u, const Velocities& dy) {
    if (rows.i != kNone) u.noalias() += rows.J_i * dy.col(rows.i);
    if (rows.j != kNone) u.noalias() += rows.J_j * dy.col(rows.j);
    return u;
  }
  Vec3 velocity(const Rows& rows, const Velocities& y) const { return changed(rows, rows.bias, y); }
  /// Adds J^T r of one column.
  static void push(const Rows& rows, const Vec3& r, Velocities& y) {
    if (rows.i != kNone) y.col(rows.i).noalias() += rows.J_i.transpose() * r;
    if (rows.j != kNone) y.col(rows.j).noalias() += rows.J_j.transpose() * r;
  }
  /// Adds J^T r.
  void push(const Impulses& r, Velocities& y) const {
    for (std::size_t k = 0; k < columns(); ++k) push(rows(k), r.col(k), y);
  }
  /// u of impulses r, with the rounding of r only: summed in long double.
  Impulses relativeVelocities(const Impulses& r) const { return velocitiesSummedIn<long double>(r); }
  /// The same with the rounding of double, in a fraction of the time.
  Impulses relativeVelocitiesAbout(const Impulses& r) const { return velocitiesSummedIn<double>(r); }
  /// Of impulses r, with their relative velocities where those are known. Where all are within `enough`, nothing is forgiven.
  Residuals residuals(const Impulses& r, const Impulses& velocity, double enough = 0.0) const;
  Residuals residuals(const Impulses& r) const { return residuals(r, relativeVelocities(r)); }

  /// The sum of the normal impulses of a torque's points.
  static double normalSum(const TorqueRows& torque, const Impulses& r) {
    return r.row(2).segment(torque.first, torque.size).sum();
  }
  /// The impulse of a torque that is nearest to x under the sum n of normal impulses.
  static Vec3 nearest(const TorqueRows& torque, const Vec3& x, double n) {
    Vec3 nearest;
    nearest << torque.rolling.nearest(x.head<2>(), n), torque.spinning.nearest(x.tail<1>(), n);
    return nearest;
  }
  /// The impulse of a column that is nearest to x; of a torque, under the normal impulses in r.
  Vec3 nearest(std::size_t k, const Vec3& x, const Impulses& r) const {
    if (k < points_.size()) return nearestOnCone(points_[k].sliding, x);
    if (k >= firstJoint()) return joints_[k - firstJoint()].box.nearest(x);
    const TorqueRows& torque = torques_[k - points_.size()];
    return nearest(torque, x, normalSum(torque, r));
  }

  /// Whether the solvers are to end.
  bool isBudgetSpent() const { return budget_ && budget_->isSpent(); }
  /// Takes so many multiplications from the budget.
  void spend(std::int64_t work) const {
    if (budget_) budget_->left -= work;
  }

  Impulses warmStart(const CoulombProblem& problem) const;
  /// The smallest that the bounds of joints allow, else zero.
  Impulses noImpulses() const;
  /// Writes impulses, and the velocities they make, with units.
  void store(const Impulses& r, CoulombProblem& problem) const;

 private:
  template <class Scalar>
  Impulses velocitiesSummedIn(const Impulses& r) const;
  double beyondRounding(const Impulses& r, const std::vector<double>& off) const;

  /// What a body makes of y, in units: v = linear y_v, w = turning y_w, where turning is L^-T; zero where it does not turn.
  struct Response {
    double linear = 0.0;
    Mat3 turning = Mat3::Zero();
  };

  double speed_, impulse_;           // the units, m/s and N s
  std::vector<Response> responses_;  // by body
  bool body_turns_ = false;          // one of them
  std::vector<Point> points_;
  std::vector<TorqueRows> torques_;
  std::vector<JointRows> joints_;
  Velocities free_;
  SolveBudget* budget_;
};

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/coulomb_system.h"

#include "base/algebra.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::coulomb {

namespace {

// L^-1 B. Eigen's own is made for large matrices.
Mat3 solveLower(const Mat3& L, Mat3 B) {
  for (int row = 0; row < 3; ++row) {
    const double inverse = 1.0 / L(row, row);
    for (int c = 0; c < 3; ++c) {
      B(row, c) *= inverse;
      for (int below = row + 1; below < 3; ++below) B(below, c) -= B(row, c) * L(below, row);
    }
  }
  return B;
}

Mat36 jacobian(double mass, const Mat3& L, const Mat3& frame, const Mat3& moments, double total_mass) {
  // u = frame^T v + moments^T w, v = y_v/sqrt(m), w = L^-T y_w.
  Mat36 J;
  J.leftCols<3>() = frame.transpose() / std::sqrt(mass / total_mass);
  J.rightCols<3>() = solveLower(L, moments).transpose() * std::sqrt(total_mass);
  return J;
}

Mat36 turning(const Mat3& L, const Mat3& frame, double radius, double total_mass) {
  // u = R frame^T w.
  Mat36 J = Mat36::Zero();
  J.rightCols<3>() = radius * solveLower(L, frame).transpose() * std::sqrt(total_mass);
  return J;
}

}  // namespace

System::System(const CoulombProblem& problem) {
  double total_mass = 0.0;
  for (const CoulombBody& body : problem.bodies) total_mass += body.mass;
  speed_ = problem.speed_unit;
  budget_ = problem.budget;
  impulse_ = total_mass * speed_;

  const auto gives = [](const CoulombPoint& point) { return point.give > 0.0; };
  const auto pads = std::count_if(problem.points.begin(), problem.points.end(), gives);
  free_.setZero(6, static_cast<Eigen::Index>(problem.bodies.size()) + pads);
  roots_.reserve(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const CoulombBody& body = problem.bodies[k];
    turns_.push_back(body.turns);
    body_turns_ = body_turns_ || body.turns;
    const Mat3 L = roots_.emplace_back(body.turns ? body.inertia_W : Mat3::Identity()).matrixL();
    free_.col(k) << std::sqrt(body.mass / total_mass) / speed_ * body.v,
        L.transpose() * body.w / (std::sqrt(total_mass) * speed_);
    if (!body.turns) free_.col(k).tail<3>().setZero();
  }
  // The spin of a body that does not turn is part of the bias of its points.
  const auto jacobianOf = [&](Index body, const Vec3& arm, const CoulombPoint& point, double sign,
                              Vec3& bias) {
    const Mat3 moments = momentsOf(arm, point.frame, point.axis_W);
    Mat36 J = jacobian(problem.bodies[body].mass, roots_[body].matrixLLT(), point.frame, moments, total_mass);
    if (!turns_[body]) {
      J.rightCols<3>().setZero();
      bias += sign * (moments.transpose() * problem.bodies[body].w);
    }
    return J;
  };
  points_.reserve(problem.points.size());
  Index pad = static_cast<Index>(problem.bodies.size());
  for (const CoulombPoint& given : problem.points) {
    Point point;
    point.i = given.i, point.j = given.j;
    point.J_i.setZero();
    point.J_j.setZero();
    point.bias = given.bias;
    if (given.i != kNone) point.J_i = -jacobianOf(given.i, given.r_i, given, -1.0, point.bias);
    if (given.j != kNone) point.J_j = jacobianOf(given.j, given.r_j, given, 1.0, point.bias);
    point.bias /= speed_;
    // A side gives way like a body of mass 1/give that moves along n alone.
    if (gives(given)) {
      (given.i == kNone ? point.i : point.j) = pad++;
      (given.i == kNone ? point.J_i : point.J_j)(2, 0) = std::sqrt(given.give * total_mass);
    }
    point.sliding = {given.mu, given.slide};
    point.response = (point.J_i.squaredNorm() + point.J_j.squaredNorm()) / 3.0;
    points_.push_back(point);
  }
  for (const TorqueConstraint& given : problem.torques) {
    TorqueRows torque;
    torque.i = given.i, torque.j = given.j;
    torque.first = given.first, torque.size = given.size;
    torque.bias = given.bias;
    const auto turningOf = [&](Index body, double sign) -> Mat36 {
      if (body == kNone) return Mat36::Zero();
      if (turns_[body])
        return sign * turning(roots_[body].matrixLLT(), given.frame, given.radius, total_mass);
      torque.bias += sign * given.radius * (given.frame.transpose() * problem.bodies[body].w);
      return Mat36::Zero();
    };
    torque.J_i = turningOf(given.i, -1.0);
    torque.J_j = turningOf(given.j, 1.0);
    torque.bias /= speed_;
    torque.rolling = {given.roll, given.rolls};
    torque.spinning = {given.spin, FrictionSet<1>::Vec(given.spins)};
    torque.response = (torque.J_i.squaredNorm() + torque.J_j.squaredNorm()) / 3.0;
    torques_.push_back(torque);
  }
  for (const BoundedRows& given : problem.joints) {
    JointRows joint;
    joint.i = given.i, joint.j = given.j;
    joint.bias = given.bias;
    const auto rowsOf = [&](Index body, const Mat36& J) -> Mat36 {
      if (body == kNone) return Mat36::Zero();
      const Mat3 linear = J.leftCols<3>(), angular = J.rightCols<3>();
      Mat36 rows = jacobian(problem.bodies[body].mass, roots_[body].matrixLLT(), linear.transpose(),
                            angular.transpose(), total_mass);
      if (!turns_[body]) {
        joint.bias += angular * problem.bodies[body].w;
        rows.rightCols<3>().setZero();
      }
      return rows;
    };
    joint.J_i = rowsOf(given.i, given.J_i);
    joint.J_j = rowsOf(given.j, given.J_j);
    joint.bias /= speed_;
    joint.box = {given.lo / impulse_, given.hi / impulse_};
    joint.response = (joint.J_i.squaredNorm() + joint.J_j.squaredNorm()) / 3.0;
    if (joint.response == 0.0) joint.response = 1.0;  // it moves nothing
    joints_.push_back(joint);
  }
}

template <class Scalar>
Impulses System::velocitiesSummedIn(const Impulses& r) const {
  Eigen::Matrix<Scalar, 6, Eigen::Dynamic> y = free_.cast<Scalar>();
  const auto push = [&](Index body, const Mat36& J, const Vec3& impulse) {
    if (body != kNone) y.col(body).noalias() += J.transpose().cast<Scalar>() * impulse.cast<Scalar>();
  };
  for (std::size_t k = 0; k < columns(); ++k) {
    push(rows(k).i, rows(k).J_i, r.col(k));
    push(rows(k).j, rows(k).J_j, r.col(k));
  }
  Impulses u(3, columns());
  for (std::size_t k = 0; k < columns(); ++k) {
    const Rows& point = rows(k);
    Eigen::Matrix<Scalar, 3, 1> sum = point.bias.cast<Scalar>();
    if (point.i != kNone) sum.noalias() += point.J_i.cast<Scalar>() * y.col(point.i);
    if (point.j != kNone) sum.noalias() += point.J_j.cast<Scalar>() * y.col(point.j);
    u.col(k) = sum.template cast<double>();
  }
  return u;
}

template Impulses System::velocitiesSummedIn<double>(const Impulses&) const;
template Impulses System::velocitiesSummedIn<long double>(const Impulses&) const;

// The residuals of a point, each a speed, from the natural maps of the three laws at the point's own scale,
// an impulse x being worth the speed response x:
//   signorini    |min(u_n, response r_n)|
//   coulomb      response (|r_T| - mu r_n)_+
//   dissipation  |response r_T - P(response r_T - u_T)|, P onto the disc of radius response mu r_n.
// Since response >= 1 (a body weighs no more than all of them), a residual in impulse is never larger than
// the same in speed, and both are within what is returned. The third is zero where and only where friction
// lies on the cone against sliding, or sliding is zero, given the second. A torque constraint has the last two, of its
// rolling and of its spinning, whichever is worse. The rows of a joint have in place of the first
//   |response r - P(response r - u)|, P onto response times their bounds,
// with the response that their scale gives.
//
// A velocity is known to within the rounding of what it is summed from, epsilon sum |J^T r|; a light body
// between heavy ones feels the last digit of their impulses. Where motions are prescribed that leave a body
// no room there is no solution: impulses grow without end, and so would what is forgiven them.
Residuals System::residuals(const Impulses& r, const Impulses& velocity) const {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  constexpr double kMostForgiven = 1e-4;
  Eigen::VectorXd rounding = free_.colwise().norm().transpose();
  for (std::size_t k = 0; k < columns(); ++k) {
    const Rows& point = rows(k);
    if (point.i != kNone) rounding[point.i] += (point.J_i.transpose() * r.col(k)).norm();
    if (point.j != kNone) rounding[point.j] += (point.J_j.transpose() * r.col(k)).norm();
  }
  Residuals worst;
  if (!velocity.allFinite()) {
    worst.signorini = worst.coulomb = worst.dissipation = worst.beyond_rounding =
        std::numeric_limits<double>::infinity();
    return worst;
  }
  const auto count = [&](const Rows& of, const Vec3& push, double signorini, double coulomb,
                         double dissipation) {
    worst.signorini = std::max(worst.signorini, signorini);
    worst.coulomb = std::max(worst.coulomb, coulomb);
    worst.dissipation = std::max(worst.dissipation, dissipation);
    double floor = push.norm() + of.bias.norm();
    if (of.i != kNone) floor += of.J_i.norm() * rounding[of.i];
    if (of.j != kNone) floor += of.J_j.norm() * rounding[of.j];
    const double forgiven = std::min(kEpsilon * floor, kMostForgiven);
    worst.beyond_rounding =
        std::max(worst.beyond_rounding, std::max(signorini, std::max(coulomb, dissipation)) - forgiven);
  };
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Point& point = points_[k];
    const Vec3 u = velocity.col(k);
    const Vec3 push = point.response * r.col(k);
    const double limit = point.sliding.factor * std::max(push[2], 0.0);
    const double signorini = std::abs(std::min(u[2], push[2]));
    double coulomb, dissipation = 0.0;
    if (point.sliding.slips) {
      coulomb = (push.head<2>() + limit * point.sliding.slip).norm();
    } else {
      coulomb = std::max(0.0, push.head<2>().norm() - limit);
      Vec2 target = push.head<2>() - u.head<2>();
      const double length = target.norm();
      if (length > limit) target *= limit / length;
      dissipation = (push.head<2>() - target).norm();
    }
    count(point, push, signorini, coulomb, dissipation);
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorqueRows& torque = torques_[k];
    double n = 0.0;
    for (std::size_t p = torque.first; p < torque.first + torque.size; ++p) n += std::max(r(2, p), 0.0);
    n *= torque.response;
    const Vec3 push = torque.response * r.col(points_.size() + k);
    const double coulomb = std::max({0.0, push.head<2>().norm() - torque.rolling.factor * n,
                                     std::abs(push[2]) - torque.spinning.factor * n});
    const Vec3 target = nearest(torque, push - velocity.col(points_.size() + k), n);
    count(torque, push, 0.0, coulomb, (push - target).norm());
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const JointRows& joint = joints_[k];
    const Impulses::ConstColXpr x = r.col(firstJoint() + k), u = velocity.col(firstJoint() + k);
    const Vec3 target = joint.box.nearest(x - u / joint.response);
    count(joint, joint.response * x, joint.response * (x - target).norm(), 0.0, 0.0);
  }
  return worst;
}

Impulses System::warmStart(const CoulombProblem& problem) const {
  Impulses r(3, columns());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Vec3 given = problem.points[k].impulse / impulse_;
    r.col(k) = given.allFinite() ? nearestOnCone(points_[k].sliding, given) : Vec3::Zero();
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorqueRows& torque = torques_[k];
    const Vec3 given = problem.torques[k].impulse / impulse_;
    r.col(points_.size() + k) =
        given.allFinite() ? nearest(torque, given, normalSum(torque, r)) : Vec3::Zero();
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const Vec3 given = problem.joints[k].impulse / impulse_;
    r.col(firstJoint() + k) = joints_[k].box.nearest(given.allFinite() ? given : Vec3::Zero());
  }
  return r;
}

Impulses System::noImpulses() const {
  Impulses r = Impulses::Zero(3, columns());
  for (std::size_t k = 0; k < joints_.size(); ++k)
    r.col(firstJoint() + k) = joints_[k].box.nearest(Vec3::Zero());
  return r;
}

void System::store(const Impulses& r, CoulombProblem& problem) const {
  for (std::size_t k = 0; k < points_.size(); ++k) {
    CoulombPoint& point = problem.points[k];
    point.impulse = impulse_ * r.col(k);
    const Vec3 impulse_W = point.frame * point.impulse;
    const auto apply = [&](Index body, const Vec3& arm, double sign) {
      problem.bodies[body].v += sign * impulse_W / problem.bodies[body].mass;
      if (!turns_[body]) return;
      const double about = momentAbout(point.axis_W, arm, point.frame.col(2));
      const Vec3 moment_W = arm.cross(impulse_W) - about * point.impulse[2] * point.axis_W;
      problem.bodies[body].w += sign * roots_[body].solve(moment_W);
    };
    if (point.i != kNone) apply(point.i, point.r_i, -1.0);
    if (point.j != kNone) apply(point.j, point.r_j, 1.0);
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    TorqueConstraint& torque = problem.torques[k];
    torque.impulse = impulse_ * r.col(points_.size() + k);
    const Vec3 turn_W = torque.radius * (torque.frame * torque.impulse);
    if (torque.i != kNone && turns_[torque.i]) problem.bodies[torque.i].w -= roots_[torque.i].solve(turn_W);
    if (torque.j != kNone && turns_[torque.j]) problem.bodies[torque.j].w += roots_[torque.j].solve(turn_W);
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    BoundedRows& joint = problem.joints[k];
    joint.impulse = impulse_ * r.col(firstJoint() + k);
    const auto apply = [&](Index body, const Mat36& J) {
      if (body == kNone) return;
      problem.bodies[body].v += J.leftCols<3>().transpose() * joint.impulse / problem.bodies[body].mass;
      if (turns_[body])
        problem.bodies[body].w += roots_[body].solve(Vec3(J.rightCols<3>().transpose() * joint.impulse));
    };
    apply(joint.i, joint.J_i);
    apply(joint.j, joint.J_j);
  }
}

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/coulomb_system.h"

#include "base/algebra.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::coulomb {

namespace {

// The inverse of a lower triangular matrix.
Mat3 inverseOfLower(const Mat3& L) {
  const double a = 1.0 / L(0, 0), b = 1.0 / L(1, 1), c = 1.0 / L(2, 2);
  Mat3 inverse;
  inverse << a, 0.0, 0.0,        //
      -b * L(1, 0) * a, b, 0.0,  //
      c * (L(2, 1) * b * L(1, 0) - L(2, 0)) * a, -c * L(2, 1) * b, c;
  return inverse;
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
  responses_.reserve(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const CoulombBody& body = problem.bodies[k];
    Response& response = responses_.emplace_back();
    response.linear = std::sqrt(total_mass / body.mass);
    free_.col(k).head<3>() = body.v / (response.linear * speed_);
    if (!body.turns) continue;
    body_turns_ = true;
    const Mat3 L = body.inertia_W.llt().matrixL();
    response.turning = std::sqrt(total_mass) * inverseOfLower(L).transpose();
    free_.col(k).tail<3>() = L.transpose() * body.w / (std::sqrt(total_mass) * speed_);
  }
  // J of a side, of linear and angular rows. The spin of a body that does not turn is part of the bias of its rows.
  const auto jacobian = [&](Index body, const Mat3& linear, const Mat3& angular, Mat36& J) {
    J.leftCols<3>() = responses_[body].linear * linear;
    J.rightCols<3>().noalias() = angular * responses_[body].turning;
  };
  points_.resize(problem.points.size());
  Index pad = static_cast<Index>(problem.bodies.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const CoulombPoint& given = problem.points[k];
    Point& point = points_[k];
    point.i = given.i, point.j = given.j;
    point.bias = given.bias;
    const auto addSide = [&](Index body, const Vec3& arm, double sign, Mat36& J) {
      if (body == kNone) return J.setZero(), void();
      const Mat3 angular = sign * momentsOf(arm, given.frame, given.axis_W).transpose();
      jacobian(body, sign * given.frame.transpose(), angular, J);
      if (!problem.bodies[body].turns) point.bias += angular * problem.bodies[body].w;
    };
    addSide(given.i, given.r_i, -1.0, point.J_i);
    addSide(given.j, given.r_j, 1.0, point.J_j);
    point.bias /= speed_;
    // A side gives way like a body of mass 1/give that moves along n alone.
    if (gives(given)) {
      (given.i == kNone ? point.i : point.j) = pad++;
      (given.i == kNone ? point.J_i : point.J_j)(2, 0) = std::sqrt(given.give * total_mass);
    }
    point.sliding = {given.mu, given.slide};
    point.response = (point.J_i.squaredNorm() + point.J_j.squaredNorm()) / 3.0;
  }
  for (const TorqueConstraint& given : problem.torques) {
    TorqueRows torque;
    torque.i = given.i, torque.j = given.j;
    torque.first = given.first, torque.size = given.size;
    torque.bias = given.bias;
    const auto addSide = [&](Index body, double sign, Mat36& J) {
      if (body == kNone) return J.setZero(), void();
      const Mat3 angular = sign * given.radius * given.frame.transpose();
      jacobian(body, Mat3::Zero(), angular, J);
      if (!problem.bodies[body].turns) torque.bias += angular * problem.bodies[body].w;
    };
    addSide(given.i, -1.0, torque.J_i);
    addSide(given.j, 1.0, torque.J_j);
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
    const auto addSide = [&](Index body, const Mat36& rows, Mat36& J) {
      if (body == kNone) return J.setZero(), void();
      const Mat3 angular = rows.rightCols<3>();
      jacobian(body, rows.leftCols<3>(), angular, J);
      if (!problem.bodies[body].turns) joint.bias += angular * problem.bodies[body].w;
    };
    addSide(given.i, given.J_i, joint.J_i);
    addSide(given.j, given.J_j, joint.J_j);
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
Residuals System::residuals(const Impulses& r, const Impulses& velocity, double enough) const {
  Residuals worst;
  if (!velocity.allFinite()) {
    worst.signorini = worst.coulomb = worst.dissipation = worst.beyond_rounding =
        std::numeric_limits<double>::infinity();
    return worst;
  }
  std::vector<double> off(columns());
  const auto count = [&](std::size_t k, double signorini, double coulomb, double dissipation) {
    worst.signorini = std::max(worst.signorini, signorini);
    worst.coulomb = std::max(worst.coulomb, coulomb);
    worst.dissipation = std::max(worst.dissipation, dissipation);
    off[k] = std::max(signorini, std::max(coulomb, dissipation));
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
    count(k, signorini, coulomb, dissipation);
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
    count(points_.size() + k, 0.0, coulomb, (push - target).norm());
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const JointRows& joint = joints_[k];
    const Impulses::ConstColXpr x = r.col(firstJoint() + k), u = velocity.col(firstJoint() + k);
    const Vec3 target = joint.box.nearest(x - u / joint.response);
    count(firstJoint() + k, joint.response * (x - target).norm(), 0.0, 0.0);
  }
  worst.beyond_rounding = worst.worst() <= enough ? worst.worst() : beyondRounding(r, off);
  return worst;
}

// A velocity is known to within the rounding of what it is summed from, epsilon sum |J^T r|; a light body
// between heavy ones feels the last digit of their impulses. Where motions are prescribed that leave a body
// no room there is no solution: impulses grow without end, and so would what is forgiven them.
double System::beyondRounding(const Impulses& r, const std::vector<double>& off) const {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  constexpr double kMostForgiven = 1e-4;
  Eigen::VectorXd rounding = free_.colwise().norm().transpose();
  for (std::size_t k = 0; k < columns(); ++k) {
    const Rows& of = rows(k);
    if (of.i != kNone) rounding[of.i] += (of.J_i.transpose() * r.col(k)).norm();
    if (of.j != kNone) rounding[of.j] += (of.J_j.transpose() * r.col(k)).norm();
  }
  double worst = 0.0;
  for (std::size_t k = 0; k < columns(); ++k) {
    const Rows& of = rows(k);
    double floor = (of.response * r.col(k)).norm() + of.bias.norm();
    if (of.i != kNone) floor += of.J_i.norm() * rounding[of.i];
    if (of.j != kNone) floor += of.J_j.norm() * rounding[of.j];
    worst = std::max(worst, off[k] - std::min(kEpsilon * floor, kMostForgiven));
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
  for (std::size_t k = 0; k < points_.size(); ++k) problem.points[k].impulse = impulse_ * r.col(k);
  for (std::size_t k = 0; k < torques_.size(); ++k)
    problem.torques[k].impulse = impulse_ * r.col(points_.size() + k);
  for (std::size_t k = 0; k < joints_.size(); ++k)
    problem.joints[k].impulse = impulse_ * r.col(firstJoint() + k);
  Velocities change = Velocities::Zero(6, free_.cols());
  push(r, change);
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    problem.bodies[k].v += speed_ * responses_[k].linear * change.col(k).head<3>();
    problem.bodies[k].w += speed_ * (responses_[k].turning * change.col(k).tail<3>());
  }
}

}  // namespace rbs::coulomb

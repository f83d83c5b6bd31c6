// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/central_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace rbs::coulomb {

namespace {

// What a solution of the linear equations may leave of their right side: without a refinement, and with one.
constexpr double kNoRefinement = 1e-9;
constexpr double kSolved = 1e-3;

}  // namespace

CentralPath::Place& CentralPath::Place::add(double part, const Place& direction) {
  y += part * direction.y;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const PointPairs& other = direction.points[k];
    points[k].r_n += part * other.r_n;
    points[k].u_n += part * other.u_n;
    points[k].sliding.add(part, other.sliding);
  }
  for (std::size_t k = 0; k < torques.size(); ++k) {
    torques[k].rolling.add(part, direction.torques[k].rolling);
    torques[k].spinning.add(part, direction.torques[k].spinning);
  }
  for (std::size_t k = 0; k < joints.size(); ++k) joints[k].add(part, direction.joints[k]);
  return *this;
}

double CentralPath::Place::normalSum(const TorqueRows& torque) const {
  double sum = 0.0;
  for (std::size_t p = torque.first; p < torque.first + torque.size; ++p) sum += points[p].r_n;
  return sum;
}

// All products begin at the same t, in units of the whole island: so the lightest bodies' are the last to
// close, which jams of 1e4 : 1 in masses need. At the same t for their own mass, half of such jams get stuck.
CentralPath::CentralPath(const System& system, BodyBlocks& matrix) : system_(system), matrix_(matrix) {
  const std::size_t size = system.points().size();
  place.y = system.free();
  // The size of the start is that of the velocities of points that close, and of the unit at least. A point
  // that opens faster than that does so at the start too.
  std::vector<Vec3> free;
  double sum = 0.0;
  for (const Point& point : system.points()) {
    free.push_back(system.velocity(point, place.y));
    if (free.back()[2] < 0.0) sum += free.back().squaredNorm();
  }
  const double start = std::max(1.0, std::sqrt(sum / std::max(static_cast<double>(size), 1.0)));
  for (std::size_t k = 0; k < size; ++k) {
    const double u_n = std::max(start, free[k][2]), r_n = start * start / u_n;
    const FrictionBarrier<2>& barrier = sliding_.emplace_back(system.points()[k].sliding);
    place.points.push_back({r_n, u_n, barrier.start(r_n, u_n)});
    count_ += barrier.isBall() ? 2 : 1;
  }
  for (const TorqueRows& torque : system.torques()) {
    const double n = place.normalSum(torque), speed = start * start / n;
    const TorqueBarriers& barriers = torques_.emplace_back(
        TorqueBarriers{FrictionBarrier<2>(torque.rolling), FrictionBarrier<1>(torque.spinning)});
    place.torques.push_back({barriers.rolling.start(n, speed), barriers.spinning.start(n, speed)});
    count_ += barriers.rolling.isBall() + barriers.spinning.isBall();
  }
  for (const JointRows& joint : system.joints()) {
    const BoxBarrier& barrier = joints_.emplace_back(joint.box, joint.response);
    place.joints.push_back(barrier.start(start * start));
    count_ += barrier.count();
  }
  D_.resize(system.columns());
  g_.resize(torques_.size());
  off_.resize(3, system.columns());
}

// A place of the boundary and one within the cones make one within them (Skajaa, Andersen and Ye, Math. Prog. Comp. 5, 2013).
void CentralPath::startNear(const Impulses& guess, double part) {
  if (part == 1.0) return;
  Impulses r(3, system_.columns());
  for (std::size_t k = 0; k < system_.columns(); ++k) r.col(k) = system_.nearest(k, guess.col(k), r);
  Place near = place;
  near.y = system_.free();
  system_.push(r, near.y);
  for (std::size_t k = 0; k < near.points.size(); ++k) {
    const Vec3 u = system_.velocity(system_.points()[k], near.y);
    near.points[k] = {r(2, k), std::max(u[2], 0.0),
                      sliding_[k].placeOf(r.col(k).head<2>(), r(2, k), u.head<2>())};
  }
  for (std::size_t k = 0; k < near.torques.size(); ++k) {
    const TorqueRows& torque = system_.torques()[k];
    const Vec3 u = system_.velocity(torque, near.y), x = r.col(near.points.size() + k);
    const double n = System::normalSum(torque, r);
    near.torques[k] = {torques_[k].rolling.placeOf(x.head<2>(), n, u.head<2>()),
                       torques_[k].spinning.placeOf(x.tail<1>(), n, u.tail<1>())};
  }
  for (std::size_t k = 0; k < near.joints.size(); ++k)
    near.joints[k] =
        joints_[k].placeOf(r.col(system_.firstJoint() + k), system_.velocity(system_.joints()[k], near.y));
  place.add(1.0 - part, near.add(-1.0, place));
}

Impulses CentralPath::impulses() const {
  Impulses r(3, system_.columns());
  const std::size_t points = place.points.size();
  for (std::size_t k = 0; k < points; ++k) {
    const PointPairs& pairs = place.points[k];
    r.col(k) << sliding_[k].impulse(pairs.sliding, pairs.r_n), pairs.r_n;
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorquePairs& pairs = place.torques[k];
    const double n = place.normalSum(system_.torques()[k]);
    r.col(points + k) << torques_[k].rolling.impulse(pairs.rolling, n),
        torques_[k].spinning.impulse(pairs.spinning, n);
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) r.col(system_.firstJoint() + k) = place.joints[k].r;
  return r;
}

double CentralPath::meanProduct() const {
  double sum = 0.0;
  for (const PointPairs& pairs : place.points)
    sum += pairs.r_n * pairs.u_n + pairs.sliding.b.dot(pairs.sliding.h);
  for (const TorquePairs& pairs : place.torques)
    sum += pairs.rolling.b.dot(pairs.rolling.h) + pairs.spinning.b.dot(pairs.spinning.h);
  for (std::size_t k = 0; k < joints_.size(); ++k) sum += joints_[k].sumOfProducts(place.joints[k]);
  return count_ == 0 ? 0.0 : sum / count_;
}

bool CentralPath::linearise() {
  const std::size_t points = place.points.size();
  away_ = place.y - system_.free();
  system_.push(-impulses(), away_);
  off_.setZero();
  for (std::size_t k = 0; k < points; ++k) {
    const PointPairs& pairs = place.points[k];
    FrictionBarrier<2>& sliding = sliding_[k];
    const Vec3 u = system_.velocity(system_.points()[k], place.y);
    off_(2, k) = pairs.u_n - u[2];
    if (sliding.isBall()) off_.col(k).head<2>() = pairs.sliding.h.head<2>() - u.head<2>();
    sliding.linearise(pairs.sliding);
    Mat3& D = D_[k];
    D.setZero();
    D(2, 2) = pairs.r_n / pairs.u_n;
    D.topLeftCorner<2, 2>() = sliding.stiffness();
    D.topRightCorner<2, 1>() = sliding.byNormal(D(2, 2));
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorquePairs& pairs = place.torques[k];
    auto& [rolling, spinning] = torques_[k];
    const Vec3 u = system_.velocity(system_.torques()[k], place.y);
    auto off = off_.col(points + k);
    if (rolling.isBall()) off.head<2>() = pairs.rolling.h.head<2>() - u.head<2>();
    if (spinning.isBall()) off[2] = pairs.spinning.h[0] - u[2];
    rolling.linearise(pairs.rolling);
    spinning.linearise(pairs.spinning);
    Mat3& D = D_[points + k];
    D.setZero();
    D.topLeftCorner<2, 2>() = rolling.stiffness();
    D.bottomRightCorner<1, 1>() = spinning.stiffness();
    g_[k] << rolling.byNormal(1.0), spinning.byNormal(1.0);
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const std::size_t column = system_.firstJoint() + k;
    joints_[k].linearise(place.joints[k]);
    off_.col(column) = joints_[k].off(system_.velocity(system_.joints()[k], place.y));
    D_[column] = joints_[k].stiffness().asDiagonal();
  }
  if (first_off_.size() == 0) first_off_ = off_, first_away_ = away_;
  return matrix_.factor(D_, g_);
}

double CentralPath::distance(double t, double share) const {
  double worst = 0.0;
  for (std::size_t k = 0; k < place.points.size(); ++k) {
    const PointPairs& pairs = place.points[k];
    worst = std::max(worst, std::abs(pairs.r_n * pairs.u_n / t - 1.0));
    worst = std::max(worst, sliding_[k].distance(t));
  }
  for (const TorqueBarriers& barriers : torques_)
    worst = std::max({worst, barriers.rolling.distance(t), barriers.spinning.distance(t)});
  for (const BoxBarrier& barrier : joints_) worst = std::max(worst, barrier.distance(t));
  for (Eigen::Index k = 0; k < off_.cols(); ++k)
    worst = std::max(worst, (off_.col(k) - share * first_off_.col(k)).norm());
  return worst;
}

bool CentralPath::step(double t, double share, const Place* earlier, Place& direction) const {
  Wanted wanted{{}, {}, {}, share * first_off_ - off_, share * first_away_ - away_};
  wanted.points.reserve(place.points.size());
  for (std::size_t k = 0; k < place.points.size(); ++k) {
    const PointPairs& pairs = place.points[k];
    const PointPairs* before = earlier ? &earlier->points[k] : nullptr;
    double product = t - pairs.r_n * pairs.u_n;
    if (before) product -= before->r_n * before->u_n;
    wanted.points.push_back({product, sliding_[k].towards(t, before ? &before->sliding : nullptr)});
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorquePairs* before = earlier ? &earlier->torques[k] : nullptr;
    wanted.torques.push_back({torques_[k].rolling.towards(t, before ? &before->rolling : nullptr),
                              torques_[k].spinning.towards(t, before ? &before->spinning : nullptr)});
  }
  for (std::size_t k = 0; k < joints_.size(); ++k)
    wanted.joints.push_back(joints_[k].towards(t, earlier ? &earlier->joints[k] : nullptr));
  return solve(wanted, direction);
}

bool CentralPath::tangent(double t, double share, Place& direction) const {
  Wanted wanted{{}, {}, {}, share * first_off_, share * first_away_};
  wanted.points.reserve(place.points.size());
  for (const FrictionBarrier<2>& sliding : sliding_) wanted.points.push_back({t, sliding.alongPath(t)});
  for (const TorqueBarriers& barriers : torques_)
    wanted.torques.push_back({barriers.rolling.alongPath(t), barriers.spinning.alongPath(t)});
  for (const BoxBarrier& barrier : joints_) wanted.joints.push_back(barrier.alongPath(t));
  return solve(wanted, direction);
}

template <class Change>
void CentralPath::addResponse(const Change& du, Velocities& y) const {
  const std::size_t points = place.points.size();
  std::vector<double> dn(torques_.empty() ? 0 : points);  // by point, of its normal impulse
  for (std::size_t k = 0; k < points; ++k) {
    const Vec3 dr = -(D_[k] * du(k));
    if (!dn.empty()) dn[k] = dr[2];
    System::push(system_.points()[k], dr, y);
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorqueRows& torque = system_.torques()[k];
    const auto first = dn.begin() + static_cast<std::ptrdiff_t>(torque.first);
    const double sum = std::accumulate(first, first + static_cast<std::ptrdiff_t>(torque.size), 0.0);
    System::push(torque, sum * g_[k] - D_[points + k] * du(points + k), y);
  }
  for (std::size_t k = system_.firstJoint(); k < system_.columns(); ++k)
    System::push(system_.rows(k), -(D_[k] * du(k)), y);
}

bool CentralPath::solve(const Wanted& wanted, Place& direction) const {
  const std::size_t points = place.points.size();
  Impulses e(3, system_.columns());
  for (std::size_t k = 0; k < points; ++k) {
    const double e_n = wanted.points[k].product / place.points[k].u_n;
    e.col(k) << sliding_[k].constant(wanted.points[k].sliding, e_n), e_n;
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const double e_n = System::normalSum(system_.torques()[k], e);
    e.col(points + k) << torques_[k].rolling.constant(wanted.torques[k].rolling, e_n),
        torques_[k].spinning.constant(wanted.torques[k].spinning, e_n);
  }
  const std::size_t first_joint = system_.firstJoint();
  for (std::size_t k = 0; k < joints_.size(); ++k)
    e.col(first_joint + k) = joints_[k].constant(wanted.joints[k]);
  Velocities right = wanted.away;
  system_.push(e, right);
  addResponse([&](std::size_t k) -> Vec3 { return wanted.off.col(k); }, right);
  direction.y = matrix_.solve(right);
  // What the factors are worth: one refinement where they have lost digits.
  Velocities rest = residual(right, direction.y);
  if (!(rest.norm() <= kNoRefinement * right.norm())) {
    direction.y += matrix_.solve(rest);
    rest = residual(right, direction.y);
    if (!(rest.norm() <= kSolved * right.norm())) return false;
  }

  direction.points.resize(points);
  direction.torques.resize(torques_.size());
  direction.joints.resize(joints_.size());
  for (std::size_t k = 0; k < points; ++k) {
    const Vec3 du = System::changed(system_.points()[k], Vec3::Zero(), direction.y) + wanted.off.col(k);
    PointPairs& d = direction.points[k];
    d.u_n = du[2];
    d.r_n = (wanted.points[k].product - place.points[k].r_n * d.u_n) / place.points[k].u_n;
    d.sliding = sliding_[k].change(wanted.points[k].sliding, du.head<2>(), d.r_n);
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorqueRows& torque = system_.torques()[k];
    const Vec3 du = System::changed(torque, Vec3::Zero(), direction.y) + wanted.off.col(points + k);
    const double dn = direction.normalSum(torque);
    direction.torques[k] = {torques_[k].rolling.change(wanted.torques[k].rolling, du.head<2>(), dn),
                            torques_[k].spinning.change(wanted.torques[k].spinning, du.tail<1>(), dn)};
  }
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const Vec3 du =
        System::changed(system_.joints()[k], Vec3::Zero(), direction.y) + wanted.off.col(first_joint + k);
    direction.joints[k] = joints_[k].change(wanted.joints[k], du);
  }
  return true;
}

/// right - (1 + J^T D J) dy.
Velocities CentralPath::residual(const Velocities& right, const Velocities& dy) const {
  Velocities rest = right - dy;
  addResponse([&](std::size_t k) { return System::changed(system_.rows(k), Vec3::Zero(), dy); }, rest);
  return rest;
}

double CentralPath::room(const Place& direction) const {
  double t = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < place.points.size(); ++k) {
    const PointPairs &pairs = place.points[k], &d = direction.points[k];
    t = std::min(t, std::min(roomWithin(pairs.r_n, d.r_n), roomWithin(pairs.u_n, d.u_n)));
    if (sliding_[k].isBall()) t = std::min(t, pairs.sliding.room(d.sliding));
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorquePairs &pairs = place.torques[k], &d = direction.torques[k];
    if (torques_[k].rolling.isBall()) t = std::min(t, pairs.rolling.room(d.rolling));
    if (torques_[k].spinning.isBall()) t = std::min(t, pairs.spinning.room(d.spinning));
  }
  for (std::size_t k = 0; k < joints_.size(); ++k)
    t = std::min(t, joints_[k].room(place.joints[k], direction.joints[k]));
  return t;
}

Eigen::VectorXd CentralPath::relative(const Place& direction) const {
  const Eigen::Index points = static_cast<Eigen::Index>(place.points.size());
  Eigen::VectorXd fractions =
      Eigen::VectorXd::Zero(8 * points + 10 * static_cast<Eigen::Index>(torques_.size()) +
                            12 * static_cast<Eigen::Index>(joints_.size()));
  for (Eigen::Index k = 0; k < points; ++k) {
    const PointPairs &pairs = place.points[k], &d = direction.points[k];
    fractions.segment<2>(8 * k) << d.r_n / pairs.r_n, d.u_n / pairs.u_n;
    if (sliding_[k].isBall()) fractions.segment<6>(8 * k + 2) = pairs.sliding.relative(d.sliding);
  }
  for (std::size_t k = 0; k < torques_.size(); ++k) {
    const TorquePairs &pairs = place.torques[k], &d = direction.torques[k];
    auto part = fractions.segment<10>(8 * points + 10 * static_cast<Eigen::Index>(k));
    if (torques_[k].rolling.isBall()) part.head<6>() = pairs.rolling.relative(d.rolling);
    if (torques_[k].spinning.isBall()) part.tail<4>() = pairs.spinning.relative(d.spinning);
  }
  for (std::size_t k = 0; k < joints_.size(); ++k)
    fractions.segment<12>(fractions.size() - 12 * static_cast<Eigen::Index>(joints_.size() - k)) =
        joints_[k].relative(place.joints[k], direction.joints[k]);
  return fractions;
}

}  // namespace rbs::coulomb

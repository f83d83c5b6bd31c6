// SPDX-License-Identifier: BSD-3-Clause
#include "solver/island_motion.h"

#include "base/algebra.h"
#include "dynamics/integrate.h"

#include <algorithm>
#include <utility>

namespace rbs {

Vec3 velocityAt(const CoulombBodies& bodies, const CoulombPoint& law) {
  Vec3 u_W = Vec3::Zero();
  if (law.j != kNone) u_W += bodies[law.j].v + bodies[law.j].w.cross(law.r_j);
  if (law.i != kNone) u_W -= bodies[law.i].v + bodies[law.i].w.cross(law.r_i);
  Vec3 u = law.frame.transpose() * u_W + law.bias;
  if (!law.axis_W.isZero(0.0)) {
    const auto about = [&](const CoulombBody& body, const Vec3& arm) {
      return momentAbout(law.axis_W, arm, law.frame.col(2)) * law.axis_W.dot(body.w);
    };
    if (law.j != kNone) u[2] -= about(bodies[law.j], law.r_j);
    if (law.i != kNone) u[2] += about(bodies[law.i], law.r_i);
  }
  return u;
}

Vec3 turningAt(const CoulombBodies& bodies, const TorqueConstraint& torque) {
  Vec3 w_W = Vec3::Zero();
  if (torque.j != kNone) w_W += bodies[torque.j].w;
  if (torque.i != kNone) w_W -= bodies[torque.i].w;
  return torque.radius * (torque.frame.transpose() * w_W) + torque.bias;
}

IslandMotion::IslandMotion(Context& context, std::vector<Index> bodies)
    : step_(context.step), bodies_(context.scene.bodies), indices_(std::move(bodies)) {
  double load = 0.0;
  for (const Index i : indices_) {
    mass_ += bodies_.traits[i].mass;
    const Vec3 spin = bodies_.inertia[i].inverseW(bodies_.R_WB(i)) * step_.load[i].torque_W;
    load = std::max(load, step_.load[i].a_W.norm() + spin.norm() * bodies_.traits[i].length);
  }
  load_speed_ = load * step_.h();
}

CoulombBodies IslandMotion::bodies() const {
  CoulombBodies out;
  out.reserve(indices_.size());
  for (const Index i : indices_) {
    const Mat3 R = bodies_.R_WB(i);
    out.push_back({bodies_.traits[i].mass, R * bodies_.inertia[i].moments.asDiagonal() * R.transpose(),
                   bodies_.twist[i].v_WB, bodies_.twist[i].w_WB, !bodies_.inertia[i].steady});
  }
  return out;
}

void IslandMotion::addLoad(CoulombBodies& bodies, double seconds) const {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Index i = indices_[k];
    const Load& load = step_.load[i];
    bodies[k].v += seconds * load.a_W;
    if (!load.torque_W.isZero(0.0))
      bodies[k].w += seconds * (bodies_.inertia[i].inverseW(bodies_.R_WB(i)) * load.torque_W);
  }
}

void IslandMotion::setTwists(const CoulombBodies& bodies) {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies_.twist[indices_[k]].v_WB = bodies[k].v;
    if (!bodies_.inertia[indices_[k]].steady) bodies_.twist[indices_[k]].w_WB = bodies[k].w;
  }
}

void IslandMotion::drift(const CoulombBodies& bodies, double seconds) {
  setTwists(bodies);
  for (const Index i : indices_) {
    bodies_.pose[i].p_WB += seconds * bodies_.twist[i].v_WB;
    rotateFreely(bodies_.pose[i].q_WB, bodies_.twist[i].w_WB, bodies_.inertia[i], seconds);
  }
}

void IslandMotion::displace(const CoulombBodies& by) {
  for (std::size_t k = 0; k < by.size(); ++k) {
    const Index i = indices_[k];
    Pose& pose = bodies_.pose[i];
    pose.p_WB += by[k].v;
    if (bodies_.inertia[i].steady) continue;
    const Mat3 R = bodies_.R_WB(i);
    const Vec3 spin_W = R * bodies_.inertia[i].moments.cwiseProduct(R.transpose() * bodies_.twist[i].w_WB);
    pose.q_WB = (rotationBy(by[k].w) * pose.q_WB).normalized();
    bodies_.twist[i].w_WB = bodies_.inertia[i].inverseW(bodies_.R_WB(i)) * spin_W;
  }
}

std::vector<BodyMotion> IslandMotion::save() const {
  std::vector<BodyMotion> out;
  out.reserve(indices_.size());
  for (const Index i : indices_) out.push_back({bodies_.pose[i], bodies_.twist[i]});
  return out;
}

void IslandMotion::restore(const std::vector<BodyMotion>& motions) {
  for (std::size_t k = 0; k < motions.size(); ++k) {
    bodies_.pose[indices_[k]] = motions[k].pose;
    bodies_.twist[indices_[k]] = motions[k].twist;
  }
}

}  // namespace rbs

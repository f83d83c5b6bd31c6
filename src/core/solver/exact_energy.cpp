// SPDX-License-Identifier: BSD-3-Clause
// The energy of an island over a segment: what it has, what it is given, and how much more it has at the end.
//
// Energy and work depend on who looks, and what they decide must not: so they are those of one frame that moves with the scene,
// that of the side which no force moves and to which the island is nearest to rest, or of its own centre of mass where it touches
// none. That frame keeps its velocity for the interval.
#include "solver/exact_stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rbs::exact_step {

// The kinetic energy against a side that moves at u is that against the centre of mass, and M |u - v|^2/2 with v of the latter: it
// is least for the u that is nearest to v.
Vec3 Stepper::frameOfEnergy() const {
  const Bodies& bodies = context_.scene.bodies;
  const Vec3 mean_W = bodies.meanVelocity(island_.indices());
  Vec3 frame_W = mean_W;
  double least = std::numeric_limits<double>::infinity();
  for (const Index k : active_)
    for (const Index i : {context_.scene.contacts.active[k].i, context_.scene.contacts.active[k].j}) {
      const double off = (bodies.twist[i].v_WB - mean_W).squaredNorm();
      if (bodies.traits[i].moved_by_forces() || off >= least) continue;
      least = off;
      frame_W = bodies.twist[i].v_WB;
    }
  return frame_W;
}

// Kinetic energy of the island, and its potential energy in the field of the loads, J, so many seconds from now on.
double Stepper::energyOf(const std::vector<BodyMotion>& motions, double seconds) const {
  const Bodies& bodies = context_.scene.bodies;
  double energy = 0.0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const Index i = island_.indices()[k];
    const auto& [pose, twist] = motions[k];
    const Vec3 v = twist.v_WB - frame_v_W_, p = pose.p_WB - seconds * frame_v_W_;
    energy += bodies.traits[i].mass * (0.5 * v.squaredNorm() - step_.load[i].a_W.dot(p)) +
              bodies.spinEnergy(i, pose.q_WB, twist.w_WB);
  }
  return energy;
}

double Stepper::kineticOf(const std::vector<BodyMotion>& motions) const {
  double energy = energyOf(motions, 0.0);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const Index i = island_.indices()[k];
    energy += context_.scene.bodies.traits[i].mass * step_.load[i].a_W.dot(motions[k].pose.p_WB);
  }
  return energy;
}

// The work that sides which no force moves have done by the impulses of these points, which are where they are at `time`, J.
double Stepper::workByKinematic(const TouchingPoints& touching, const PointsOfContacts& opened,
                                double time) const {
  const Bodies& bodies = context_.scene.bodies;
  double work = 0.0;
  const auto add = [&](Index k, const Vec3& p_W, const Vec3& impulse_W) {
    const Contact& contact = context_.scene.contacts.active[k];
    for (const auto& [side, sign] : {std::pair(contact.i, 1.0), std::pair(contact.j, -1.0)}) {
      if (bodies.traits[side].moved_by_forces()) continue;
      const Twist& twist = bodies.twist[side];
      const Vec3 r = p_W - step_.poseAt(bodies, side, time).p_WB;
      work += sign * impulse_W.dot(twist.v_WB - frame_v_W_ + twist.w_WB.cross(r));
    }
  };
  for (const TouchingPoint& point : touching.points) add(point.contact, point.p_W, point.impulse_W);
  for (const auto& [k, point] : opened)
    add(k, point.p_W, point.normal_impulse * point.n_W + point.friction_impulse_W);
  return work;
}

// The work of the torques on the bodies in a segment, J.
double Stepper::workOfTorques(const std::vector<BodyMotion>& start) const {
  double work = 0.0;
  for (std::size_t k = 0; k < start.size(); ++k) {
    const Vec3 spin_W = 0.5 * (start[k].twist.w_WB + segment_.end[k].twist.w_WB);
    work += tau_ * step_.load[island_.indices()[k]].torque_W.dot(spin_W);
  }
  return work;
}

// What a segment has gained beyond twice of what it was given, as a share of its kinetic energy, of what it was given, and of
// the energy of a fall for one step; negative where it has lost. Twice, since the work of a body that turns is known to the
// first power of the length alone.
double Stepper::gainOf(const std::vector<BodyMotion>& start, double kinematic_before) const {
  const double by_kinematic = workByKinematic(segment_.touching, {}, now_ + tau_) +
                              workByKinematic({}, segment_.opened, now_) +
                              workByKinematic({}, opened_, now_) - kinematic_before;
  const double given = std::abs(by_kinematic) + std::max(workOfTorques(start), 0.0) + elasticEnergy();
  const double fall = 0.5 * island_.mass() * island_.loadSpeed() * island_.loadSpeed();
  const double unit = kineticOf(start) + given + fall;
  return (energyOf(segment_.end, tau_) - energyOf(start, 0.0) - 2.0 * given) /
         std::max(unit, std::numeric_limits<double>::min());
}

}  // namespace rbs::exact_step

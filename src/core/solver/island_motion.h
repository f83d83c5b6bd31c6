// SPDX-License-Identifier: BSD-3-Clause
// The bodies of one island as the exact step moves them: kicks change velocities, drifts change places.
#pragma once

#include "coulomb/coulomb_problem.h"
#include "state/context.h"

#include <vector>

namespace rbs {

using CoulombBodies = std::vector<CoulombBody>;

/// Velocity of j against i at a point, in its frame, its bias included, m/s.
Vec3 velocityAt(const CoulombBodies& bodies, const CoulombPoint& law);

/// Angular velocity of j against i times the length of the torque constraint, in its frame, its bias included, m/s.
Vec3 turningAt(const CoulombBodies& bodies, const TorqueConstraint& torque);

struct BodyMotion {
  Pose pose;
  Twist twist;
};

class IslandMotion {
 public:
  /// @param bodies in the order of their indices
  IslandMotion(Context& context, std::vector<Index> bodies);

  const std::vector<Index>& indices() const { return indices_; }
  double mass() const { return mass_; }
  /// The most that the load changes the velocity of a surface in a step, m/s.
  double loadSpeed() const { return load_speed_; }

  /// The bodies as they are, in the order of the indices.
  CoulombBodies bodies() const;
  void addLoad(CoulombBodies& bodies, double seconds) const;
  void setTwists(const CoulombBodies& bodies);
  void drift(const CoulombBodies& bodies, double seconds);
  /// Moves the bodies by the lengths and angles in v and w. Each keeps its velocity and angular momentum.
  void displace(const CoulombBodies& by);
  std::vector<BodyMotion> save() const;
  void restore(const std::vector<BodyMotion>& motions);

 private:
  const StepStore& step_;
  Bodies& bodies_;
  std::vector<Index> indices_;
  double mass_ = 0.0, load_speed_ = 0.0;
};

}  // namespace rbs

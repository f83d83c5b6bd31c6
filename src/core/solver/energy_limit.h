// SPDX-License-Identifier: BSD-3-Clause
// Islands in which bodies overlap deeply gain no energy.
//
// Each pair that overlaps parts no faster than its cap. But what is squeezed between two would need v /
// sin(alpha) to part from both at v, if their sides are alpha from parallel, and in a chain or a crowd the speeds
// of the pairs add up. So an island in which bodies overlap deeply gains no energy: it ends the step with what it had, what its loads did, and what kinematic
// bodies may give it. What is too much is taken from the motions about the common centre first, which keeps the momentum.
// The rest is taken from the common motion, along the directions in which contacts with bodies that forces do not move can
// push: what glides on a floor without friction keeps its speed along it.
//
// Nor does an island gain energy whose bodies turn or travel too fast for the most sub-steps: no contact can follow
// them. There each sub-step is held to it.
#pragma once

#include "solver/island_energy.h"

namespace rbs {

class EnergyLimit {
 public:
  /// Finds the islands with deep overlaps, or all of them, and what they may have at the end.
  void find(const Context& context, const SolverContacts& contacts, bool all);
  /// There are none.
  bool empty() const { return islands_.empty(); }
  /// Takes away from the velocities what an island has gained in so many seconds.
  void apply(const Context& context, double seconds, SolverContacts& contacts) const;

 private:
  IslandEnergies islands_;
  std::vector<Mat3>
      pushed_;  // by place: the projection on the directions in which the island is pushed from outside
};

}  // namespace rbs

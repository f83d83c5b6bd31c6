// SPDX-License-Identifier: BSD-3-Clause
// Islands in which bodies overlap deeply gain no energy.
//
// Each pair that overlaps parts no faster than its cap. But what is wedged between two would need v /
// sin(alpha) to part from both at v, if their sides are alpha from parallel (a light body between heavy ones
// left at 2 km/s), and in a chain or a crowd the speeds of the pairs add up. So an island in which bodies
// overlap deeply gains no energy: it ends the step with what it had, what its loads did, and what kinematic
// bodies may give it. Nor does one whose bodies turn or travel too fast for the most sub-steps: no contact
// can follow them, and a needle of 8,000 rad/s left a plate with 1e15 rad/s. There each sub-step is held to
// it. Where bodies only need more sub-steps than the setting has, contacts can follow them but for the
// extremes: a plate of 5 mm between a slab and a heavy body left with 1e6 rad/s. They may gain a small share
// in the whole solve, which others do not reach; one that gains more is left with none of it. Close to these limits
// contacts can be followed too, but not always: there only a gain that no parting gives is taken away.
#pragma once

#include "solver/island_energy.h"

namespace rbs {

class EnergyLimit {
 public:
  /// Finds the islands with deep overlaps, or all of them, and what they may have at the end. They may gain `gain`, a
  /// share of it and of `falls` times what each body gains in a fall by its own length.
  void find(const Context& context, const SolverContacts& contacts, bool all, double gain = 0.0,
            double falls = 0.0);
  /// Takes away from the velocities what an island has gained beyond that.
  void apply(const Context& context, SolverContacts& contacts) const;

 private:
  IslandEnergies islands_;
  double gain_ = 0.0, falls_ = 0.0;
};

}  // namespace rbs

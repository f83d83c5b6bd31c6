// SPDX-License-Identifier: BSD-3-Clause
// What rolls on a flat surface gains no energy in the soft step.
//
// In a sub-step of length h a cone on its side turns with its angular velocity w about the line that it touched at the
// start, while that line goes round with it at a rate W. So its axis comes down, by the order of w W h^2 of its length,
// and the soft contact lifts it again without taking the work from its velocities: it fell for nothing, and cones gained
// 1 to 2 % of their energy a second, for ever, and coins on their rims 1 % in 10 s.
//
// So a body that rolls there ends the step with the kinetic energy T that it had, the work of its load, and what moving
// bodies did to it by the impulses p of its contacts, all as seen by one that moves at the velocity U with which what it
// rolls on began the step: a floor that moves steadily gives nothing. With u the velocity of another body where they touch,
//   T <= T_0 + m a.(dx - U h) + M.dphi + sum max(p.(u_0 - U), p.(u - U), 0).
// What is too much is taken from its spin, so that impulses and momentum stay in balance; friction slows its centre.
//
// What rocks on a round surface is left alone: the energy of a step of first order goes up in one half of a swing by
// what it goes down in the other, and a bound would damp it.
#pragma once

#include "solver/island_energy.h"

#include <vector>

namespace rbs {

class RollingEnergy {
 public:
  /// Finds the bodies that roll on a flat surface, and takes their energies.
  void find(const Context& context, const SolverContacts& contacts);
  /// There are none.
  bool empty() const { return rollers_.empty(); }
  /// Slows the spin of those that have gained, `seconds` later.
  void apply(const Context& context, double seconds, SolverContacts& contacts) const;

 private:
  struct Roller {
    Index body;     // in SolverContacts::bodies
    double energy;  // kinetic, at the start, as seen by what it rolls on, J
    Vec3 U_W;       // velocity of that at the start, m/s
  };
  std::vector<Roller> rollers_;  // by body, ascending
};

}  // namespace rbs

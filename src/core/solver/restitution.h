// SPDX-License-Identifier: BSD-3-Clause
// Restitution in the soft step: impacts that were not resolved at their time (impacts.h) rebound at its end.
//
// A point that came at a speed u0 worth a rebound and was pushed leaves at e u0 (Newton's law, a pass over
// the points). The u0 of several points were taken at one time, but in truth their blows follow each other,
// and each changes what the next one meets: a box that tumbles on an elastic floor would gain energy with
// every turn. So the rebounds of an island are scaled by one share 0 <= s <= 1, the largest with which it has
// no more energy than at the start and what its loads have done since. With v and dv the velocities before
// them and what they add, M the masses, that is
//   s² dv.M dv / 2 + s v.M dv + v.M v / 2 <= E,
// and s keeps what holds at both ends: the balance of momentum, and that nothing closes. An island that a
// moving kinematic body pushes may gain energy, so it is left as it is.
#pragma once

#include "solver/island_energy.h"

#include <vector>

namespace rbs {

class Restitution {
 public:
  /// At the start: takes the energies of the islands that may rebound.
  void begin(const Context& context, const SolverContacts& contacts);
  /// No island may rebound.
  bool empty() const { return islands_.empty(); }
  /// After so many seconds: makes the rebounds, and adds their impulses to those of the points.
  void apply(const Context& context, double seconds, SolverContacts& contacts) const;

 private:
  /// By island: the share of the change from `before` to `after` that leaves it with what it may have.
  std::vector<double> sharesOf(const Context& context, double seconds, const std::vector<SolverBody>& before,
                               const std::vector<SolverBody>& after) const;

  IslandEnergies islands_;
};

}  // namespace rbs

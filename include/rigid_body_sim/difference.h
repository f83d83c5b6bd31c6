// SPDX-License-Identifier: BSD-3-Clause
// How far two runs of one scene have gone apart.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <string>

namespace rbs {

/// Of the dynamic bodies of two snapshots.
struct Difference {
  std::string moved_body;   ///< the one that is farthest from its other self; empty: none moved
  double distance = 0.0;    ///< of its centre of mass, m
  std::string turned_body;  ///< the one that is turned most against its other self; empty: none turned
  double angle = 0.0;       ///< rad
  /// Of kinetic and potential energy together, as a share of the kinetic energy and of what it takes to lift
  /// every body by its bounding radius.
  double energy = 0.0;
};

/// Of two snapshots with the same bodies.
Difference differenceOf(const Snapshot& run, const Snapshot& truth);

}  // namespace rbs

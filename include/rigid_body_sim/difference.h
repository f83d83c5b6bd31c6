// SPDX-License-Identifier: BSD-3-Clause
// The deviation between two runs of one scene.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <string>

namespace rbs {

/// Deviation of one run from another run of the same scene. It covers the dynamic bodies.
struct Difference {
  std::string moved_body;   ///< body with the largest distance between the runs; empty: no position differs
  double distance = 0.0;    ///< distance between the two centres of mass of that body, m
  std::string turned_body;  ///< body with the largest angle between the runs; empty: no orientation differs
  double angle = 0.0;       ///< angle between the two orientations of that body, rad
  /// Difference of the total energy (kinetic and potential), >= 0, dimensionless. It is a fraction of the
  /// kinetic energy of `truth` and of the energy that lifts every dynamic body by its bounding radius,
  /// together. 0 where both are zero.
  double energy = 0.0;
};

/// Compares the dynamic bodies of two snapshots. Both must hold the same bodies in the same order, which is
/// not checked. Cost: all bodies.
Difference differenceOf(const Snapshot& run, const Snapshot& truth);

}  // namespace rbs

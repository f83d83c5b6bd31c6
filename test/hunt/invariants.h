// SPDX-License-Identifier: BSD-3-Clause
// What must hold in any scene, whatever its solution: told from a run itself, without a reference.
#pragma once

#include "rigid_body_sim/scene.h"

#include <optional>
#include <string>

namespace rbs::hunt {

/// What a run has broken.
struct Finding {
  std::string invariant;  ///< its name
  double figure = 0.0, allowed = 0.0;
  int step = 0;        ///< from 1
  std::string detail;  ///< where and what, in words
};

/// One line: "energy: 0.03 in step 7, 0.001 allowed (…)".
std::string text(const Finding& finding);

struct Demands {
  int steps = 60;
  /// CPU time that a step may take, s; 0: any. It depends on the machine, so no test asks for it.
  double seconds_per_step = 0.0;
  /// How deep a pair may overlap at the exact settings, share of its smaller extent. What is asked is 1e-4;
  /// a hard impact in a step of 1/10 s leaves more (docs/stability.md).
  double overlap = 1e-4;
};

/// Steps the scene and checks in each step:
///   finite       every pose and velocity is finite, and no body is frozen;
///   energy       kinetic and potential energy do not grow: where nothing kinematic moves, no body overlaps
///                another deeply, and there is no air. In shares of the largest kinetic energy so far and of
///                what a fall by one size makes;
///   balance      a body's momentum changes by its weight and the impulses that the step reports, and by
///                nothing else; not where bodies overlap deeply;
///   plane        no body goes through a static plane by more than half of its smallest extent;
///   cone         friction on a plane is at most mu times the normal impulse, at the exact settings;
///   overlap      bodies that a solver says to have solved do not sink into each other, at the exact settings;
///   step_time    see Demands::seconds_per_step.
/// Then the run is made again: saved as text and restored at half time, and in other units, powers of two,
/// which round alike. The end must be the same, bit for bit:
///   restored, units.
/// Returns the first that does not hold; nothing if all do.
std::optional<Finding> firstBroken(const SceneDef& scene, const Demands& demands);

}  // namespace rbs::hunt

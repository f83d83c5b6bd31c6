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
///   energy       kinetic and potential energy do not grow by more than the work of kinematic bodies: where no body overlaps
///                another deeply, and there is no air. In shares of the largest kinetic energy so far and of
///                what a fall by one size makes;
///   balance      a body's momentum changes by its weight and the impulses that the step reports, and by
///                nothing else; not where bodies overlap deeply;
///   plane        no body goes through a static plane by more than half of its smallest extent;
///   cone         friction on a plane is at most mu times the normal impulse, at the exact settings;
///   overlap      bodies that a solver says to have solved do not sink into each other, at the exact settings;
///   certificate  what is said to have converged has small residuals, at the exact settings; computed anew,
///                bodies that touch do not close either;
///   count        the impacts of a step end by their budget;
///   step_time    see Demands::seconds_per_step.
/// Then the run is made again: saved as text and restored at half time, and in other units, powers of two,
/// which round alike. The end must be the same, bit for bit:
///   restored, units.
/// And seen in a mirror, and with its bodies in the reverse order:
///   mirrored, reordered. At the exact settings a step begun alike ends alike, where both converge and meet
///   no impacts. The order of impacts at one instant is nobody's to tell.
/// Returns the first that does not hold; nothing if all do.
std::optional<Finding> firstBroken(const SceneDef& scene, const Demands& demands);

/// By how much one step differs in `coarse` and in `fine` parts: the largest distance of a body, in its
/// bounding radii. It is the fifth step of the scene, when bodies have met. Nothing where a solve does not
/// converge, or where bodies that begin elsewhere by 1e-10 of their radii end elsewhere by a thousandth: after dozens of
/// impacts no step is right.
std::optional<double> stepError(const SceneDef& scene, int coarse, int fine);

}  // namespace rbs::hunt

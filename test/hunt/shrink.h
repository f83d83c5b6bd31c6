// SPDX-License-Identifier: BSD-3-Clause
// Makes a scene that breaks an invariant as small as it can be while it still breaks it.
#pragma once

#include "invariants.h"

namespace rbs::hunt {

struct Small {
  SceneDef scene;
  Finding finding;
};

/// Leaves out bodies, velocities, turns, materials and air as long as the same invariant is broken,
/// in 300 tries at most.
Small shrink(const SceneDef& scene, const Demands& demands, const Finding& finding);

}  // namespace rbs::hunt

// SPDX-License-Identifier: BSD-3-Clause
// Planes that stop what would go through them.
//
// A light body between a heavy fast one and a plane leaves the two with more speed than a step can follow. So the plane
// itself stops a body at half of its smallest extent, or where it was at the start of the step: it is lifted up to there, and
// goes no deeper. That is an impulse of the plane at the foot of the body's centre.
#pragma once

#include "state/context.h"

namespace rbs::plane_stop {

Need need(const SceneAnalysis& analysis);

/// Lifts the bodies that are too deep, at the end of the step. Looks at each body for each plane.
void run(Context& context);

}  // namespace rbs::plane_stop

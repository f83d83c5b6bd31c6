// SPDX-License-Identifier: BSD-3-Clause
// How far the islands are from the laws of contact after their solves, and what is checked before the result
// of a step is handed out.
#pragma once

#include "state/context.h"

namespace rbs::residuals {

Need need(const SceneAnalysis& analysis);

/// Adds those of one solve to those of its island: the worst residuals, the sum of the iterations, the most
/// expensive solver.
void add(IslandResiduals& residuals, const IslandResiduals& solve);

/// Puts the deepest penetration and the residuals of the islands in contact into the report. A body whose
/// state is not finite is put back to where the step found it and frozen, and the report says so.
void check(Context& context);

}  // namespace rbs::residuals

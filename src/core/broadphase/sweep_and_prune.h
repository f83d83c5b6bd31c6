// SPDX-License-Identifier: BSD-3-Clause
// Sweep and prune on the axis (1, 1, 1): the candidate pairs of a step.
#pragma once

#include "state/context.h"

namespace rbs::sweep_and_prune {

/// Fills step.bounds, and makes scene.contacts those of every pair of bodies whose swept bounds overlap, that
/// may collide by group and mask, and of which at least one moves.
void run(Context& context);

/// Whether two bodies may collide at all.
bool mayCollide(const Traits& a, const Traits& b);

}  // namespace rbs::sweep_and_prune

// SPDX-License-Identifier: BSD-3-Clause
// Which islands the exact step solves, and which the soft step.
#pragma once

#include "state/context.h"

namespace rbs {

/// Chooses island.exact. At the exact settings: every island but those that deep overlaps rule. At the fast ones: those that the
/// soft step would do badly and that a direct solve can afford. It goes by counts and not by time, so every machine decides
/// alike. Where the step begins again, the forces are those of the attempt before. Counts
/// step.moving_pairs and island.moving_pairs.
void chooseSolver(Context& context, Island& island);

/// The choice for an island that two are merged into.
bool isExactTogether(const Context& context, const Island& a, const Island& b);

/// At the settings that promote: whether a heavy body of a small island moves so fast on a light one that the soft step
/// would press the light one through what it lies on. Asked after impacts.
bool isCrushing(const Context& context, const Island& island);

}  // namespace rbs

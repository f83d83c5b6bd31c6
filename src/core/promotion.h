// SPDX-License-Identifier: BSD-3-Clause
// Which islands the fast settings hand to the exact step.
#pragma once

#include "context.h"

namespace rbs {

/// Whether the soft step would do badly on an island that a direct solve can afford: by counts of the state
/// before the step alone, so that every machine decides alike. An island that was exact in the last step
/// stays so until it is clearly no longer that kind (hysteresis).
bool isPromoted(const Context& context, const Island& island);

}  // namespace rbs

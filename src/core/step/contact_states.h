// SPDX-License-Identifier: BSD-3-Clause
// What contacts are as a step begins: some touch, since one of their points bore a force at the end of the last one, and some
// are between bodies that rest side by side without touching.
#pragma once

#include "state/context.h"

#include <functional>

namespace rbs::contact_states {

/// Makes the pairs that touch `Touching`, and the bodies that forces move in them supported (StepStore::supported). Then, at
/// the fast settings, makes pairs `Separated` that are not to touch in this step, so that towers beside each other are islands
/// of their own, and a body in a pile is no neighbour of those behind the next one. The exact settings solve groups of any
/// size, and a pair that is missed costs them more than many that do not touch. Costs all active contacts, and a query of
/// the narrow phase for each that rests and does not touch.
void classify(Context& context);

/// Makes those candidates `of` which this holds `Separated` that rest and are not to touch in this step. Nothing at the exact
/// settings.
void separateResting(Context& context, const std::function<bool(const Contact&)>& of);

}  // namespace rbs::contact_states

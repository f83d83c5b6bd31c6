// SPDX-License-Identifier: BSD-3-Clause
// Contacts that touch as a step begins: one of their points bore a force at the end of the last one.
#pragma once

#include "state/context.h"

namespace rbs::touching_contacts {

/// Makes their pairs `Touching`, and the bodies that forces move in them supported (StepStore::supported). Costs all
/// active contacts.
void find(Context& context);

}  // namespace rbs::touching_contacts

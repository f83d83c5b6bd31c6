// SPDX-License-Identifier: BSD-3-Clause
// Ballistic bodies: gravity is all they feel, and there is nothing that they can meet.
#pragma once

#include "context.h"

namespace rbs::ballistic {

Need need(const Census& census);
/// Moves them over the step, in closed form. Their attitudes are carried along where they do not turn at a
/// constant rate.
void run(Context& context);

}  // namespace rbs::ballistic

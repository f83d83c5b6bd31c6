// SPDX-License-Identifier: BSD-3-Clause
// Islands on their way through a step: each is advanced by the method that it needs.
#pragma once

#include "state/context.h"

namespace rbs {

/// Advances an island to this time, if it is not there yet.
void advanceTo(Context& context, Island& island, double time);

/// Advances all islands to the end of the step. Those that no impact has cut are advanced together, by
/// method.
void advanceToEnd(Context& context);

/// Adds up what the islands have to report.
void reportIslands(Context& context);

}  // namespace rbs

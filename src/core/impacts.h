// Impacts: closing pairs whose contact is located in time and resolved at that time, in order.
//
// A pair is looked at when it can rebound (restitution above 0) or when it moves too far in one step to be
// left to the contact solver. All other contacts, and those that close too slowly to rebound within a step,
// are the contact solver's.
#pragma once

#include "context.h"

namespace rbs::impacts {

Need need(const Census& census);

/// Finds the pairs that will impact during the step, and takes them out of the contact solve (step.waits).
void find(Context& context);

/// The impact of i and j at or after `from`, if there is one before the end of the step and it is not left
/// to the contact solver.
std::optional<PendingImpact> locate(const Context& context, Index i, Index j, double from);

/// Coefficient of restitution of a pair. Where it is 0, a pair in contact is left to the contact solver.
double restitution(const Context& context, Index i, Index j);

enum class Outcome {
  Rebound,  ///< the bodies part
  Stay,     ///< they stay together: from here on a contact
  Miss,     ///< they are not where they were expected
};
/// Resolves the impact of i and j at `time`.
Outcome resolve(Context& context, Index i, Index j, double time);

}  // namespace rbs::impacts

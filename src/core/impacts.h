// Impacts: closing pairs whose contact is located in time and resolved at that time, in order.
//
// A pair in contact that has no restitution is the contact solver's, and so is one that closes too slowly for
// a rebound to be seen. All others are looked at.
#pragma once

#include "context.h"

namespace rbs::impacts {

Need need(const Census& census);

/// Finds the pairs that will impact during the step, and takes them out of the contact solve
/// (Standing::Awaited).
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

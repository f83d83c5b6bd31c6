// SPDX-License-Identifier: BSD-3-Clause
// Islands: the connected parts of the constraint graph, over the bodies that forces move.
#pragma once

#include "base/disjoint_sets.h"
#include "state/context.h"

#include <vector>

namespace rbs::islands {

Need need(const SceneAnalysis& analysis);

/// Makes the islands of the step from the edges of all kinds of constraints, and chooses their solvers. Fills
/// step.islands and step.island.
void build(Context& context);
/// Makes those of some bodies alone, in ascending order, behind the islands that are there. No edge may tie
/// them to others that forces move.
void build(Context& context, const std::vector<Index>& bodies);

/// Makes the islands of these bodies that edges connect. Edges of other bodies are left out.
void connect(Context& context, const std::vector<Index>& bodies, const std::vector<Edge>& edges);

/// The bodies that forces move, united where the broad phase found them near each other, they met in the step or constraints
/// connect them: what one does in the step, those of other sets do not feel.
DisjointSets candidateSets(const Context& context);

/// Makes one island of two that have been advanced to the same time, and gives the place of it.
Index merge(Context& context, Index a, Index b);

}  // namespace rbs::islands

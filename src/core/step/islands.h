// SPDX-License-Identifier: BSD-3-Clause
// Islands: the connected parts of the constraint graph, over the bodies that forces move.
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs::islands {

Need need(const SceneAnalysis& analysis);

/// The edge of contact k.
Edge edgeOf(const Contacts& contacts, Index k);

/// Makes the islands of the step from the edges of all kinds of constraints, and chooses their solvers. Fills
/// step.islands and step.island.
void build(Context& context);

/// Makes the islands that these edges connect. Edges of bodies that forces do not move are left out.
void connect(Context& context, const std::vector<Edge>& edges);

/// Makes one island of two that have been advanced to the same time, and gives the place of it.
Index merge(Context& context, Index a, Index b);

}  // namespace rbs::islands

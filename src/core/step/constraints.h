// SPDX-License-Identifier: BSD-3-Clause
// The edges of the constraint graph: of contacts, and of the other kinds (solver/constraint_kinds.h).
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs::constraints {

/// The edge of contact k.
Edge edgeOf(const Contacts& contacts, Index k);

/// Those of the other kinds, kind by kind, each in canonical order.
std::vector<Edge> otherEdges(const SceneStore& scene);

/// The constraints that take part in this step as it stands: kind by kind, each in canonical order. Costs all constraints.
std::vector<Edge> edges(const SceneStore& scene);

/// Those over which a body that moves wakes one that sleeps, and keeps one awake that is at rest. A contact is one from
/// where the bounds of its bodies overlap, before they touch. Costs all contacts of awake bodies, and all constraints of other kinds.
std::vector<Edge> wakingEdges(const SceneStore& scene);

}  // namespace rbs::constraints

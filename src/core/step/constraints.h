// SPDX-License-Identifier: BSD-3-Clause
// THE table of the kinds of constraints, as stages see them: which bodies each constraint ties, and from which to which what
// moves wakes what sleeps. How a kind is solved stands in a file of its own below solver/, which SoftStep names.
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs::constraints {

/// The edge of contact k.
Edge edgeOf(const Contacts& contacts, Index k);

/// The constraints that take part in this step as it stands: the kinds in the order of the table, each in canonical order.
/// Costs all constraints.
std::vector<Edge> tying(const SceneStore& scene);

/// Those over which a body that moves wakes one that sleeps, and keeps one awake that is at rest. A contact is one from
/// where the bounds of its bodies overlap, before they touch. Costs all constraints of awake bodies.
std::vector<Edge> waking(const SceneStore& scene);

}  // namespace rbs::constraints

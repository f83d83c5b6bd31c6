// SPDX-License-Identifier: BSD-3-Clause
// What contacts bring together before its time.
//
// Impacts are predicted as if each body went on alone. In an island that is brought to an impact its contacts have
// pushed bodies off that trajectory, and two that no contact keeps apart may be in each other: the impact between them would
// come late, from inside. So what has been brought there goes back, and both are looked at when they were about to
// touch. With the separations s_0 > 0 at t_0, where both began, and s_1 < 0 at t_1, where the impact is, that is, as of a
// steady approach, at
//   t = t_0 + (t_1 - t_0) s_0/(s_0 - s_1);
// and where s_0 is no more than rounding, when they are in each other by as little. A thin body may even be through the
// other, and apart from it again: then t is when the two first touch on ways from where they began to where they are, with the
// acceleration that was expected of them and constant spins.
// From there the two are predicted anew. What contacts do to them in the little time that is left is little.
#pragma once

#include "state/context.h"

#include <functional>
#include <optional>
#include <vector>

namespace rbs {

/// Brings islands, by their places, to `time` as advanceTo() does, and looks at the pairs that `others` gives for a body of
/// theirs, when all are there: bodies that no contact keeps apart from it. Where some of them overlap then and did not
/// before, or have met on the way, all islands are put back, and this is the first time at which a pair is to be looked at,
/// with the pair; only the work that solves have cost stays counted, and whether it was too much. Costs a copy of the islands, 1 us a pair, a time of
/// impact for each that may have met, and the solves again where it goes back.
std::optional<PendingImpact> advanceUnlessEarly(Context& context, const std::vector<Index>& islands,
                                                double time,
                                                const std::function<std::vector<Index>(Index)>& others);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// What contacts bring together before its time.
//
// Impacts are predicted as if no contact acted. While an island is advanced to an impact, its contacts push bodies off these
// trajectories, and two of them may overlap when it arrives: the impact between them would come late, from inside. Then the
// island is put back, and the pair is looked at when it first touched. For a steady approach from the separation s_0 > 0 at
// t_0 to s_1 < 0 at t_1 that is
//   t = t_0 + (t_1 - t_0) s_0/(s_0 - s_1);
// where s_0 is no more than rounding, when they overlap by as little. A thin body may already be through the other. Then t
// is the time of impact on the paths from where they began to where they are, with the expected accelerations and constant
// spins. The pair is predicted again from t. What contacts do to it in the little time that is left is little.
#pragma once

#include "state/context.h"

#include <functional>
#include <optional>
#include <vector>

namespace rbs {

/// Whether an island may have left its predicted trajectory by `time`. Contacts, torques and drag cause that, and so does a support
/// that is gone. False at the fast settings: soft contacts leave larger overlaps than this prevents.
bool isWatched(const StepStore& step, const Island& island, double time);
/// Whether bodies may meet and rebound though no impact was predicted: an island is watched to the end of the step.
bool mayMeetUnforeseen(const Context& context);

/// Brings islands, by their places, to `time` as advanceTo() does, and looks at the pairs that `others` gives for a body of
/// theirs, when all are there: bodies that no contact keeps apart from it. Where some of them overlap then and did not
/// before, or have met on the way, all islands are put back, and this is the first time at which a pair is to be looked at,
/// with the pair; only the work that solves have cost stays counted, and whether it was too much. Costs a copy of the
/// islands, 1 us a pair, a time of impact for each that may have met, and the solves again where it goes back.
std::optional<PendingImpact> advanceUnlessEarly(Context& context, const std::vector<Index>& islands,
                                                double time,
                                                const std::function<std::vector<Index>(Index)>& others);

}  // namespace rbs

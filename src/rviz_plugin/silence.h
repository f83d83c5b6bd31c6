// SPDX-License-Identifier: BSD-3-Clause
// When a node that is not heard counts as gone.
#pragma once

namespace rbs {

inline constexpr int kWatchPeriod = 250;  ///< time between two looks, ms
inline constexpr int kSilence =
    8;  ///< looks without a status between them, after which the node counts as gone

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The place of a body, contact or constraint in an array of its kind.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace rbs {

using Index = std::uint32_t;
inline constexpr Index kNone = 0xffffffffu;  ///< no place
using IndexPairs = std::vector<std::pair<Index, Index>>;

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The place of a body, contact or constraint in an array of its kind.
#pragma once

#include <cstdint>

namespace rbs {

using Index = std::uint32_t;
inline constexpr Index kNone = 0xffffffffu;  ///< no place

}  // namespace rbs

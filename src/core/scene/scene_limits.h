// SPDX-License-Identifier: BSD-3-Clause
// How large a scene file may be.
#pragma once

#include <cstddef>

namespace rbs {

inline constexpr std::size_t kMostBodies = 100'000;
inline constexpr std::size_t kMostSceneBytes = 64u << 20;
inline constexpr std::size_t kMostMeshPoints = 4'000'000;  // seconds of work

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Random scenes: bodies of all shapes, sizes, masses and materials in situations of several kinds.
#pragma once

#include "rigid_body_sim/scene.h"

#include <cstdint>

namespace rbs::hunt {

/// The scene of a seed: 1 to 12 dynamic bodies, any setting, and a step of 1/1000 s to 1/10 s; to 1 s where
/// extremes meet. It is sound by validate(). The same seed makes the same scene.
SceneDef randomScene(std::uint64_t seed);

}  // namespace rbs::hunt

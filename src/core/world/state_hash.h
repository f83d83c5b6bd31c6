// SPDX-License-Identifier: BSD-3-Clause
// The state hash: one number for the whole state of a world.
#pragma once

#include "state/context.h"

namespace rbs {

/// Equal for bodies with equal futures in one world at one time, where nothing rests.
std::uint64_t bodyHash(const Bodies& bodies, Index i);

/// Equal for worlds with equal futures: bodies, settings, user forces, wrenches, time, and the forces that
/// warm-start the contacts. 64 bits, over all bits of these. Costs about 0.05 us a body, and as much a contact.
std::uint64_t stateHash(const SceneStore& scene);

}  // namespace rbs

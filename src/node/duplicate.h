// SPDX-License-Identifier: BSD-3-Clause
// Copies of bodies.
#pragma once

#include "rigid_body_sim/world.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rbs {

/// Places in world.bodies() of the bodies of these names, in this order. Throws InvalidInput for an empty list,
/// an unknown name and a name that is given twice.
std::vector<std::size_t> indicesNamed(const World& world, const std::vector<std::string>& names,
                                      const std::string& field = "names");

/// Adds `count` copies of each of these bodies, with its velocity and properties. Copy k, from 1, is at k times
/// `offset` (in W, m) from its original. A zero offset is upwards, so far that the balls around the originals
/// and those around their copies just miss each other. Returns the handles of the copies of the first name,
/// then of the next. Throws InvalidInput for names as indicesNamed() does, for a plane without an offset, and
/// for more than 100,000 copies.
std::vector<BodyId> duplicate(World& world, const std::vector<std::string>& names, std::uint32_t count,
                              const Vec3& offset);

}  // namespace rbs

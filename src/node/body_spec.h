// SPDX-License-Identifier: BSD-3-Clause
// From the fields of a request to a body or an edit, with the defaults of what was left out.
#pragma once

#include "rigid_body_sim/world.h"

#include <rigid_body_sim/BodySpec.h>
#include <rigid_body_sim/SetBody.h>
#include <rigid_body_sim/SpawnBody.h>

#include <string>
#include <vector>

namespace rbs {

/// The shape that a request describes. A hull's `pose` comes as that of the frame of its points and is led to
/// that of the body; of other shapes the two are the same. Throws InvalidInput.
Shape shapeFrom(const rigid_body_sim::BodySpec& spec, const std::string& path, Pose& pose);

/// The bodies to be made, in order; those without a pose at free places above the origin. Throws
/// InvalidInput with every problem of every body.
std::vector<BodyDef> bodiesFrom(const std::vector<rigid_body_sim::BodySpec>& specs, const World& world);

/// The same for one body.
BodyDef bodyFrom(const rigid_body_sim::SpawnBody::Request& request, const World& world);

/// The properties to change. Throws InvalidInput with every list that holds more than one.
BodyEdit editFrom(const rigid_body_sim::SetBody::Request& request);

/// The one element of a list, or nothing. Throws InvalidInput where there are more.
template <class Value>
std::optional<Value> oneOrNone(const std::vector<Value>& list, const std::string& path) {
  if (list.empty()) return std::nullopt;
  if (list.size() == 1) return list.front();
  throw InvalidInput({{path, std::to_string(list.size()) + " entries", "none, or one"}});
}

}  // namespace rbs

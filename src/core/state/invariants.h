// SPDX-License-Identifier: BSD-3-Clause
// What always holds of the stores between steps and at the end of a step. Builds with assertions check it
// once a step (scripts/test --debug); others do not look.
#pragma once

#include "state/context.h"

#include <string>

namespace rbs::invariants {

/// The first thing that is wrong with what a scene holds between steps, in words; empty when all is right.
/// Costs as much as sorting its bodies.
std::string broken(const SceneStore& scene);

/// The first thing that is wrong at the end of a step, before its contacts are kept for the next; as above.
std::string broken(const SceneStore& scene, const StepStore& step);

/// Whether there is no fault; prints it to the standard error if there is one. For assert().
bool hold(const std::string& fault);

}  // namespace rbs::invariants

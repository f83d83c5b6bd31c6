// SPDX-License-Identifier: BSD-3-Clause
// The broad phase: the candidate pairs of a step.
//
// Where a sweep along one axis takes few tests a body, it is the fastest. Its tests grow with n^1.5, or faster in a
// flat or mixed scene. From a number of tests on a tree of bounds takes its place.
#pragma once

#include "state/context.h"

#include <string>

namespace rbs::broad_phase {

/// Fills step.bounds, and makes scene.contacts those of every pair of bodies whose swept bounds overlap, that
/// may collide by group and mask, and of which at least one moves.
void findPairs(Context& context);

/// How it searches and why, for people; empty before its first search.
std::string describe(const SceneStore& scene);

}  // namespace rbs::broad_phase

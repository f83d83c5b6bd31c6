// SPDX-License-Identifier: BSD-3-Clause
// The hunt in short: scenes that once broke an invariant, and random ones of fixed seeds.
#include "invariants.h"
#include "random_scene.h"

#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

namespace rbs::hunt {
namespace {

TEST(Hunt, WhatWasFoundHolds) {
  const std::vector<SceneEntry> kept = listScenes(RBS_HUNT_KEPT);
  EXPECT_GE(kept.size(), 8u);
  for (const SceneEntry& entry : kept) {
    const auto broken = firstBroken(readScene(findScene(RBS_HUNT_KEPT, entry.name)).scene, {60});
    EXPECT_FALSE(broken) << entry.name << ": " << text(*broken);
  }
}

TEST(Hunt, RandomScenesHold) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto broken = firstBroken(randomScene(seed), {60, 0.0, 0.05});
    EXPECT_FALSE(broken) << "seed " << seed << ": " << text(*broken);
  }
}

// The same seed makes the same scene, and others make others, at every setting.
TEST(Hunt, SeedsTellScenesApart) {
  EXPECT_EQ(writeScene(randomScene(7)), writeScene(randomScene(7)));
  std::array<int, kFidelities.size()> settings{};
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    ++settings[static_cast<std::size_t>(randomScene(seed).fidelity.preset)];
  for (const int times : settings) EXPECT_GT(times, 10);
}

}  // namespace
}  // namespace rbs::hunt

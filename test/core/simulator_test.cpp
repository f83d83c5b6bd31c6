// SPDX-License-Identifier: BSD-3-Clause
// The thread that owns a world: pause, step, reset, edits from other threads, and errors that come back.
#include "rigid_body_sim/simulator.h"

#include "make_scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <thread>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

SceneDef fallingBall() {
  SceneDef scene;
  scene.bodies.push_back(ball("ball", 0.5, Vec3::Zero()));
  return scene;
}

Simulator::Options paused() {
  Simulator::Options options;
  options.paused = true;
  return options;
}

TEST(Simulator, TakesExactlyTheStepsItIsAsked) {
  Simulator simulator(fallingBall(), paused());
  EXPECT_EQ(simulator.snapshot()->steps, 0u);
  simulator.step(7);
  EXPECT_EQ(simulator.snapshot()->steps, 7u);
  simulator.step(1000);
  EXPECT_EQ(simulator.snapshot()->steps, 1007u);
}

TEST(Simulator, StepsOnlyWhilePausedAndOnlyAPossibleNumber) {
  Simulator simulator(fallingBall(), paused());
  EXPECT_THROW(simulator.step(0), InvalidInput);
  EXPECT_THROW(simulator.step(1000001), InvalidInput);
  EXPECT_EQ(simulator.snapshot()->steps, 0u);
  simulator.resume();
  EXPECT_THROW(simulator.step(1), InvalidInput);
}

TEST(Simulator, RunsUntilItIsPaused) {
  Simulator simulator(fallingBall(), {});
  while (simulator.snapshot()->steps < 3) std::this_thread::yield();
  simulator.pause();
  const std::uint64_t steps = simulator.snapshot()->steps;
  simulator.edit([](World&) {});
  EXPECT_EQ(simulator.snapshot()->steps, steps);
  EXPECT_TRUE(simulator.snapshot()->paused);
  EXPECT_FALSE(simulator.togglePause());
}

TEST(Simulator, ResetComesBackToTheSceneAsItWasLoaded) {
  Simulator simulator(fallingBall(), paused());
  const std::uint64_t hash = World(fallingBall()).stateHash();
  simulator.step(10);
  simulator.edit([](World& world) { world.addBody(ball("more", 0.1, Vec3(5.0, 0.0, 0.0))); });
  simulator.reset();
  std::uint64_t after = 0;
  simulator.edit([&](World& world) { after = world.stateHash(); });
  EXPECT_EQ(after, hash);
}

TEST(Simulator, TheCountersOfChangesGrowOnResetAndLoad) {
  Simulator simulator(fallingBall(), paused());
  const std::vector<std::function<void()>> changes = {[&] { simulator.reset(); }, [&] { simulator.load(fallingBall()); }};
  for (const auto& change : changes) {
    const auto before = simulator.snapshot();
    change();
    EXPECT_GT(simulator.snapshot()->edits, before->edits);
    EXPECT_GT(simulator.snapshot()->description_version, before->description_version);
  }
}

TEST(Simulator, WhatAnEditThrowsIsThrownToTheOneWhoAsked) {
  Simulator simulator(fallingBall(), paused());
  EXPECT_THROW(simulator.edit([](World& world) { world.removeBody(BodyId{99}); }), InvalidInput);
  EXPECT_THROW(simulator.setSpeed(-1.0), InvalidInput);
  SceneDef faulty = fallingBall();
  faulty.step = -1.0;
  EXPECT_THROW(simulator.load(faulty), InvalidInput);
  simulator.step(1);
  EXPECT_EQ(simulator.snapshot()->steps, 1u);
}

TEST(Simulator, ManyThreadsMayEditAtOnce) {
  Simulator simulator(fallingBall(), {});
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&simulator, k] {
      for (int n = 0; n < 50; ++n) {
        const std::string name = "b" + std::to_string(k) + "_" + std::to_string(n);
        simulator.edit([&](World& world) { world.addBody(ball(name, 0.1, Vec3(10.0 * k, n, 0.0))); });
        simulator.snapshot();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(simulator.snapshot()->bodies->size(), 201u);
}

}  // namespace

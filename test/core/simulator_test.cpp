// SPDX-License-Identifier: BSD-3-Clause
// The thread that owns a world: pause, step, reset, edits from other threads, and errors that come back.
#include "rigid_body_sim/simulator.h"

#include "make_scene.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
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
  const std::vector<std::function<void()>> changes = {[&] { simulator.reset(); },
                                                      [&] { simulator.load(fallingBall()); }};
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

// A request for steps on a thread of its own, as a client makes one.
struct Request {
  std::future<StepsTaken> answer;
  Request(Simulator& simulator, std::uint64_t n, std::function<bool()> go_on = nullptr)
      : answer(std::async(std::launch::async, [&simulator, n, go_on] { return simulator.step(n, go_on); })) {
    while (simulator.pace().steps_left == 0) std::this_thread::yield();
  }
};

constexpr std::uint64_t kMany = 1000000;

TEST(Simulator, EditsRunBetweenTheStepsOfARequestAndDoNotEndIt) {
  Simulator simulator(fallingBall(), paused());
  constexpr std::uint64_t n = 100000;
  Request request(simulator, n);
  std::uint64_t left = n;
  for (int k = 0; k < 10; ++k) {
    simulator.edit([](World& world) { world.setGravity(Vec3(0.0, 0.0, -1.0)); });
    const std::uint64_t now = simulator.pace().steps_left;
    EXPECT_LE(now, left);
    left = now;
  }
  EXPECT_GT(left, 0u) << "ten edits took as long as a hundred thousand steps";
  const StepsTaken taken = request.answer.get();
  EXPECT_EQ(taken.steps, n);
  EXPECT_EQ(taken.ended_by, "");
  EXPECT_EQ(simulator.snapshot()->steps, n);
  EXPECT_EQ(simulator.pace().steps_left, 0u);
}

TEST(Simulator, PauseResumeResetAndLoadEndARequest) {
  const std::vector<std::pair<std::string, void (*)(Simulator&)>> ends = {
      {"pause", [](Simulator& s) { s.pause(); }},
      {"pause", [](Simulator& s) { EXPECT_TRUE(s.togglePause()); }},
      {"resume", [](Simulator& s) { s.resume(); }},
      {"reset", [](Simulator& s) { s.reset(); }},
      {"load", [](Simulator& s) { s.load(fallingBall()); }},
  };
  for (const auto& [name, end] : ends) {
    Simulator simulator(fallingBall(), paused());
    Request request(simulator, kMany);
    end(simulator);
    const StepsTaken taken = request.answer.get();
    EXPECT_EQ(taken.ended_by, name);
    EXPECT_LT(taken.steps, kMany);
    EXPECT_EQ(simulator.pace().paused, name != "resume");
    if (name == "pause") EXPECT_EQ(simulator.snapshot()->steps, taken.steps);
  }
}

TEST(Simulator, ASecondRequestIsRefusedAtOnce) {
  Simulator simulator(fallingBall(), paused());
  Request request(simulator, kMany);
  EXPECT_THROW(simulator.step(1), InvalidInput);
  EXPECT_GT(simulator.pace().steps_left, 0u);
  simulator.pause();
  EXPECT_EQ(request.answer.get().ended_by, "pause");
  EXPECT_EQ(simulator.step(1).steps, 1u);
}

TEST(Simulator, ARequestEndsWhenItsOwnerOrTheSimulatorGoes) {
  Simulator simulator(fallingBall(), paused());
  std::atomic<bool> wanted{true};
  Request request(simulator, kMany, [&] { return wanted.load(); });
  wanted = false;
  EXPECT_EQ(request.answer.get().ended_by, "shutdown");

  auto gone = std::make_unique<Simulator>(fallingBall(), paused());
  Request left(*gone, kMany);
  gone.reset();
  EXPECT_EQ(left.answer.get().ended_by, "shutdown");
}

TEST(Simulator, SnapshotsComeHoweverFarItFallsBehind) {
  Simulator::Options options;
  options.speed = 1e6;  // no step ever catches up
  Simulator simulator(fallingBall(), options);
  std::uint64_t last = 0;
  for (int k = 0; k < 5; ++k) {
    while (simulator.snapshot()->steps == last) std::this_thread::yield();
    last = simulator.snapshot()->steps;
  }
  while (simulator.pace().lost_time == 0.0) std::this_thread::yield();
  const Pace pace = simulator.pace();
  EXPECT_EQ(pace.requested_speed, 1e6);
  EXPECT_LT(pace.achieved_speed, 1e6);
  simulator.pause();
  EXPECT_EQ(simulator.pace().achieved_speed, 0.0);
  EXPECT_EQ(simulator.pace().lost_time, 0.0);
}

TEST(Simulator, WhatIsSentRunsInOrderAndIsSeenWithoutAStep) {
  Simulator simulator(fallingBall(), paused());
  for (int k = 0; k < 100; ++k)
    simulator.send(
        [k](World& world) { world.addBody(ball("b" + std::to_string(k), 0.1, Vec3(3.0, 3.0 * k, 0.0))); });
  while (simulator.snapshot()->bodies->size() < 101) std::this_thread::yield();
  EXPECT_EQ(simulator.snapshot()->bodies->back().name, "b99");
}

// The new world is made beside the old one, which goes on.
TEST(Simulator, ALoadHoldsUpNothing) {
  Simulator simulator(fallingBall(), paused());
  SceneDef large;
  for (int k = 0; k < 50000; ++k)
    large.bodies.push_back(ball("b" + std::to_string(k), 0.1, Vec3(k % 300, k / 300, 0.0)));
  std::atomic<bool> loaded{false};
  std::thread loader([&] {
    simulator.load(std::move(large));
    loaded = true;
  });
  int edits = 0;
  for (; !loaded; ++edits) simulator.edit([](World&) {});
  loader.join();
  EXPECT_GT(edits, 20);
  EXPECT_EQ(simulator.snapshot()->bodies->size(), 50000u);
}

TEST(Simulator, ElapsedTimeGoesOnThroughResetAndLoad) {
  Simulator simulator(fallingBall(), paused());
  const double step = fallingBall().step;
  simulator.step(6);
  simulator.reset();
  EXPECT_NEAR(simulator.snapshot()->elapsed, 6.0 * step, 1e-12);
  EXPECT_EQ(simulator.snapshot()->time, 0.0);
  simulator.step(3);
  SavedState later;
  later.time = 100.0;
  simulator.load(fallingBall(), later);
  EXPECT_NEAR(simulator.snapshot()->elapsed, 9.0 * step, 1e-12);
  simulator.step(1);
  EXPECT_NEAR(simulator.snapshot()->elapsed, 10.0 * step, 1e-12);
  EXPECT_EQ(simulator.snapshot()->world, 2u);
}

}  // namespace

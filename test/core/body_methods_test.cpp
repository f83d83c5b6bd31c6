// SPDX-License-Identifier: BSD-3-Clause
// What a snapshot says of each body's way through the last step: its method and its island.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <string>

using namespace rbs;
using namespace rbs::test;

namespace {

BodyState stateOf(const World& world, const std::string& name) {
  const Snapshot snapshot = world.snapshot();
  return snapshot.states[snapshot.find(name)];
}

std::string methodOf(const World& world, const std::string& name) {
  return stateOf(world, name).method;
}

// Two stacks of two boxes that stand, and a ball that flies over them.
SceneDef stacksAndBall() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  for (const double x : {0.0, 5.0})
    for (const int level : {0, 1})
      scene.bodies.push_back(
          box("box_" + std::to_string(scene.bodies.size()), Vec3::Ones(), Vec3(x, 0.0, 0.5 + level)));
  scene.bodies.push_back(ball("ball", 0.5, Vec3(10.0, 0.0, 100.0)));
  return scene;
}

TEST(BodyMethods, NameIslandsByTheirOldestBody) {
  World world(stacksAndBall());
  const std::string floor = world.bodies()->front().name;
  EXPECT_EQ(methodOf(world, "box_1"), "") << "no step yet";
  world.step();
  EXPECT_EQ(stateOf(world, "box_2").island, stateOf(world, "box_1").id);
  EXPECT_EQ(stateOf(world, "box_1").island, stateOf(world, "box_1").id);
  EXPECT_EQ(stateOf(world, "box_4").island, stateOf(world, "box_3").id);
  EXPECT_EQ(stateOf(world, "ball").island, stateOf(world, "ball").id);
  EXPECT_EQ(methodOf(world, "ball"), "flight");
  EXPECT_EQ(methodOf(world, floor), "");
  EXPECT_FALSE(stateOf(world, floor).island);
}

TEST(BodyMethods, AreThoseOfTheResiduals) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = stacksAndBall();
    scene.fidelity = fidelity;
    World world(scene);
    for (int k = 0; k < 20; ++k) {
      const StepReport report = world.step();
      ASSERT_EQ(report.residuals.size(), 2u);
      EXPECT_EQ(methodOf(world, "box_2"), report.residuals[0].method) << fidelityName(fidelity);
      EXPECT_EQ(methodOf(world, "box_4"), report.residuals[1].method) << fidelityName(fidelity);
    }
  }
}

TEST(BodyMethods, OfABodyThatFeelsGravityAloneIsBallistic) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies = {ball("ball", 0.5, Vec3::Zero())};
  World world(scene);
  world.step();
  EXPECT_EQ(methodOf(world, "ball"), "ballistic");
  EXPECT_FALSE(stateOf(world, "ball").island);
}

// Also of a saved state, where no step has been taken, and after an edit, which wakes all.
TEST(BodyMethods, OfWhatSleepsKeepTheIsland) {
  SceneDef scene = stacksAndBall();
  scene.effects[Effect::Sleeping] = true;
  World world(scene);
  advance(world, 2.0);
  const auto expectAsleep = [](const World& world, const char* when) {
    EXPECT_EQ(methodOf(world, "box_4"), "asleep") << when;
    EXPECT_EQ(stateOf(world, "box_4").island, stateOf(world, "box_3").id) << when;
  };
  expectAsleep(world, "two seconds at rest");
  const World loaded(world.capture(), world.captureState());
  expectAsleep(loaded, "a saved state");
  world.setGravity(Vec3(0.0, 0.0, -9.0));
  expectAsleep(world, "an edit");
  world.step();
  EXPECT_NE(methodOf(world, "box_4"), "asleep");
}

// The place of a body among the others changes when an older one is removed.
TEST(BodyMethods, StayWithTheirBodies) {
  World world(stacksAndBall());
  world.step();
  const BodyState box = stateOf(world, "box_4"), ball = stateOf(world, "ball");
  world.removeBody(world.find("box_1"));
  EXPECT_EQ(stateOf(world, "box_4").island, box.island);
  EXPECT_STREQ(stateOf(world, "box_4").method, box.method);
  EXPECT_STREQ(stateOf(world, "ball").method, ball.method);
}

}  // namespace

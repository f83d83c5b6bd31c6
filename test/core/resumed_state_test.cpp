// SPDX-License-Identifier: BSD-3-Clause
// A resumed state goes on as the world that it was taken from: what that world has been through must not matter.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

World resumed(const World& world) {
  return World(world.capture(), world.captureExactState());
}

class ResumedState : public ::testing::TestWithParam<Fidelity> {};

// Whether the search for missed contacts runs goes by what sleeps, and not by whether something has ever rested.
TEST_P(ResumedState, TakesTheSameStepsWhereBodiesMaySleep) {
  for (unsigned seed = 0;
       seed < (GetParam() == Fidelity::Preview || GetParam() == Fidelity::Interactive ? 40u : 5u); ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double from, double to) {
      return std::uniform_real_distribution<>(from, to)(random);
    };
    SceneDef scene = onFloor(1.0 / 30.0, 0.5);
    scene.fidelity = GetParam();
    scene.effects[Effect::Sleeping] = true;
    for (int k = 0; k < 8; ++k) {
      const double size = uniform(0.2, 0.5);
      const std::array<Shape, 3> shapes{Capsule{size / 2.0, size}, Cylinder{size, 2.0 * size},
                                        Box{Vec3::Constant(size)}};
      BodyDef def = body("body_" + std::to_string(k), shapes[random() % shapes.size()],
                         {uniform(-0.7, 0.7), uniform(-0.7, 0.7), uniform(0.5, 2.5)});
      def.twist = {{uniform(-2.0, 2.0), uniform(-2.0, 2.0), 0.0},
                   {uniform(-5.0, 5.0), uniform(-5.0, 5.0), 0.0}};
      def.material.restitution = 0.5;
      scene.bodies.push_back(def);
    }
    World world(scene);
    for (int k = 0; k < 40; ++k) {
      World other = resumed(world);
      world.step(), other.step();
      ASSERT_EQ(world.stateHash(), other.stateHash()) << "seed " << seed << ", step " << k;
    }
  }
}

// The contacts of what has just woken carry it, so that the wind finds it at rest.
TEST_P(ResumedState, TakesTheSameStepsInAirAfterAnEditHasWokenAll) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = GetParam();
  scene.air = Air{100.0};
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("crate", {0.4, 0.5, 0.1}, {0.0, 0.0, 0.05}));
  scene.bodies.push_back(ball("ball", 0.2, {2.0, 0.0, 0.2}));
  World world(scene);
  advance(world, GetParam() == Fidelity::Preview ? 15.0 : 4.0);
  world.setWind(Wind{{1.0, 0.0, 0.0}});
  World other = resumed(world);
  for (int k = 0; k < 5; ++k) {
    world.step(), other.step();
    ASSERT_EQ(world.stateHash(), other.stateHash()) << k;
  }
}

// The places that crowded bodies are taken to have go by what a saved state keeps.
TEST_P(ResumedState, PartsACrowdAsBefore) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = GetParam();
  for (int k = 0; k < 12; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Constant(0.4), {0.0, 0.0, 1.0}));
  World world(scene);
  world.removeBody(world.find("box_3"));
  World other = resumed(world);
  for (int k = 0; k < 20; ++k) {
    world.step(), other.step();
    ASSERT_EQ(world.stateHash(), other.stateHash()) << k;
  }
}

// Nobody carries it any more.
TEST(SavedStates, HaveWhatWasCarriedAtRest) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(ball("ball", 0.2, {0.0, 0.0, 2.0}));
  World world(scene);
  world.hold(world.find("ball"), Pose{{5.0, 0.0, 3.0}, Quat::Identity()});
  for (int k = 0; k < 3; ++k) world.step();
  ASSERT_GT(stateOf(world, "ball").twist.v_WB.norm(), 1.0);
  EXPECT_TRUE(stateOf(World(world.capture(), world.captureState()), "ball").twist.v_WB.isZero(0.0));
  EXPECT_EQ(World(world.capture(), world.captureExactState()).stateHash(), world.stateHash());
}

TEST(SavedStates, ThatNoWorldLeavesAreRefused) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(ball("ball", 0.2, {0.0, 0.0, 0.2}));
  World world(scene);
  world.step();
  SavedState late = world.captureState();
  late.time = 1e17;  // a step more is the same time
  EXPECT_THROW(World(world.capture(), late), InvalidInput);
  SavedState twice = world.captureState();
  ASSERT_EQ(twice.contacts.size(), 1u);
  twice.contacts.push_back(twice.contacts.front());
  EXPECT_THROW(World(world.capture(), twice), InvalidInput);
  for (const std::uint32_t body : {0u, 1u}) {  // the floor, and the ball
    SavedState asleep = world.captureState();
    asleep.rest.push_back({body, 99, body});
    if (scene.bodies[body].kind == BodyKind::Dynamic) {
      EXPECT_NO_THROW(World(world.capture(), asleep));
    } else {
      EXPECT_THROW(World(world.capture(), asleep), InvalidInput) << "what forces do not move does not sleep";
    }
  }
  SavedState unrested = world.captureState();
  unrested.rest.push_back({1u, 0, 1u});
  EXPECT_THROW(World(world.capture(), unrested), InvalidInput) << "what sleeps has rested before";
}

INSTANTIATE_TEST_SUITE_P(Settings, ResumedState, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return std::string(fidelityName(info.param)); });

}  // namespace

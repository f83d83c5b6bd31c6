// SPDX-License-Identifier: BSD-3-Clause
// Promises of the default setting on scenes that break simulators.
#include "make_scene.h"

#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

SceneDef stackOfTen(double gap) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  for (int k = 0; k < 10; ++k)
    scene.bodies.push_back(
        box("box_" + std::to_string(k), Vec3::Ones(), Vec3(0.0, 0.0, 0.5 + k * (1.0 + gap))));
  return scene;
}

TEST(Stability, AStackOfTenBoxesStandsForAMinute) {
  const SceneDef scene = stackOfTen(0.0);
  World world(scene);
  advance(world, 60.0);
  for (int k = 0; k < 10; ++k) {
    const BodyState state = stateOf(world, "box_" + std::to_string(k));
    EXPECT_LE((state.pose.p_WB - scene.bodies[k + 1].pose.p_WB).norm(), 5e-3) << k;
    EXPECT_LE(state.twist.v_WB.norm(), 1e-9) << k;
  }
}

TEST(Stability, AStackComesToRestInTwoSeconds) {
  World world(stackOfTen(0.001));
  advance(world, 2.0);
  EXPECT_LE(world.totals().kinetic_energy, 1e-4 * 1000.0 * kGravity);  // of a box that falls its own length
}

TEST(Stability, ABallOf300MetresASecondNeverPassesAWallOfTwoCentimetres) {
  for (const double step : {1.0 / 60.0, 1.0 / 240.0, 1.0 / 30.0}) {
    for (const double e : {0.0, 0.5, 1.0}) {
      for (int shot = 0; shot < 24; ++shot) {
        SceneDef scene = emptySpace(step);
        BodyDef wall = box("wall", Vec3(0.02, 40.0, 40.0), Vec3::Zero());
        wall.kind = BodyKind::Static;
        BodyDef bullet = ball("ball", 0.05, Vec3(-3.0 - 0.37 * shot, 0.0, 0.0));
        bullet.material.restitution = e;
        bullet.twist.v_WB = 300.0 * Vec3(std::cos(0.04 * shot), std::sin(0.04 * shot), 0.0);
        bullet.twist.w_WB = Vec3(0.0, 0.0, 10.0 * shot);
        scene.bodies = {wall, bullet};
        World world(scene);
        for (int k = 0; k < 6; ++k) {
          world.step();
          ASSERT_LE(stateOf(world, "ball").pose.p_WB.x(), 0.0)
              << "step " << step << ", e " << e << ", shot " << shot;
        }
      }
    }
  }
}

TEST(Stability, ASpinningRodNeverPassesAFloorItIsShotAt) {
  for (int shot = 0; shot < 30; ++shot) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    BodyDef rod = box("rod", Vec3(1.0, 0.05, 0.05), Vec3(0.0, 0.0, 2.0 + 0.1 * shot));
    rod.twist = {Vec3(3.0, 0.0, -100.0), Vec3(0.0, 7.0 * shot, 3.0)};
    rod.material.restitution = shot % 3 * 0.4;
    scene.bodies.push_back(rod);
    World world(scene);
    for (int k = 0; k < 30; ++k) {
      world.step();
      ASSERT_GE(stateOf(world, "rod").pose.p_WB.z(), 0.0) << "shot " << shot << ", step " << k;
    }
  }
}

TEST(Stability, AnOverlapMadeByAnEditIsPushedOutGently) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.bodies.push_back(box("big", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  scene.bodies.push_back(box("small", Vec3(0.4, 0.4, 0.4), Vec3(0.0, 0.0, 1.2)));
  World world(scene);
  advance(world, 2.0);
  BodyEdit larger;
  larger.shape = Box{Vec3(1.3, 1.3, 1.3)};
  world.editBody(world.find("big"), larger);
  EXPECT_NEAR((*world.snapshot().bodies)[1].mass, 1000.0 * 1.3 * 1.3 * 1.3, 1e-9 * 2197.0);
  const double fastest = std::sqrt(kGravity * 0.4);  // L of the smaller body
  for (int k = 0; k < 120; ++k) {
    world.step();
    EXPECT_LE(stateOf(world, "small").twist.v_WB.norm(), fastest * (1.0 + 1e-9)) << k;
    EXPECT_LE(stateOf(world, "big").twist.v_WB.norm(), fastest * (1.0 + 1e-9)) << k;
  }
  EXPECT_NEAR(stateOf(world, "big").pose.p_WB.z(), 0.65, 2e-3);
  EXPECT_NEAR(stateOf(world, "small").pose.p_WB.z(), 1.5, 4e-3);
}

TEST(Stability, TheSameSceneTwiceIsTheSameToTheLastBit) {
  for (const char* name : {"playground", "windy_day", "dominoes", "newtons_cradle"}) {
    const SceneDef scene = readScene(std::string(RBS_SCENES) + "/" + name + ".yaml").scene;
    World one(scene), two(scene);
    for (int k = 0; k < 120; ++k) one.step(), two.step();
    EXPECT_EQ(one.stateHash(), two.stateHash()) << name;
  }
}

TEST(Stability, ASavedStateGoesOnToTheLastBit) {
  for (const char* name : {"playground", "windy_day", "tower"}) {
    World world(readScene(std::string(RBS_SCENES) + "/" + name + ".yaml").scene);
    for (int k = 0; k < 60; ++k) world.step();
    World resumed(world.capture(), world.captureState());
    EXPECT_EQ(world.stateHash(), resumed.stateHash()) << name;
    for (int k = 0; k < 60; ++k) world.step(), resumed.step();
    EXPECT_EQ(world.stateHash(), resumed.stateHash()) << name;
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Whole steps of a core that has one kind of constraint more.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <string>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr double kStep = 1.0 / 60.0;

class Coupled : public testing::TestWithParam<Fidelity> {
 protected:
  World worldOf(SceneDef scene) const {
    scene.fidelity = GetParam();
    return World(ordered(scene));
  }
};

BodyDef post(const std::string& name, const Vec3& p_W) {
  BodyDef def = ball(name, 0.05, p_W);
  def.kind = BodyKind::Static;
  return def;
}

// By its own motion it would stay where it is, in front of a wall.
TEST_P(Coupled, WhatIsTakenAlongIsNotPredictedToStay) {
  for (const double gap : {1e-6, 1e-5, 1e-4}) {
    SceneDef scene = emptySpace(kStep);
    BodyDef wall = box("wall", {0.02, 2.0, 2.0}, {0.11 + gap, 0.0, 0.0});
    wall.kind = BodyKind::Static;
    BodyDef fast = ball("fast", 0.1, {0.0, 5.0, 0.0});
    fast.twist.v_WB = {8.0, 0.0, 0.0};
    scene.bodies = {wall, fast, ball("coupled_to_fast", 0.1, Vec3::Zero())};
    World world = worldOf(scene);
    EXPECT_EQ(world.step().repeated, 0u) << gap;
    EXPECT_LE(stateOf(world, "coupled_to_fast").pose.p_WB.x(), gap + 1e-3);
  }
}

TEST_P(Coupled, WhatHangsOnWhatSleepsSleepsAndWakesWithIt) {
  SceneDef scene = onFloor(kStep, 0.5);
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("standing", Vec3::Constant(0.2), {0.0, 0.0, 0.1}));
  scene.bodies.push_back(ball("coupled_to_standing", 0.1, {3.0, 0.0, 2.0}));
  World world = worldOf(scene);
  advance(world, 2.0);
  for (const char* name : {"standing", "coupled_to_standing"})
    EXPECT_STREQ(stateOf(world, name).method, "asleep") << name;
  world.applyImpulse(world.find("standing"), {3.0, 0.0, 0.0}, Vec3::Zero());
  world.step();
  const double speed = stateOf(world, "coupled_to_standing").twist.v_WB.x();
  EXPECT_GT(speed, 0.01);
  EXPECT_NEAR(speed, stateOf(world, "standing").twist.v_WB.x(), 0.05 * speed);
}

// It turns on the spot, and takes nothing along.
TEST_P(Coupled, WhatHangsOnABodyThatTurnsStaysAwake) {
  for (const double spin : {0.0, 0.01}) {
    SceneDef scene = onFloor(kStep, 0.5);
    scene.effects[Effect::Sleeping] = true;
    BodyDef hook = post("hook", {3.0, 0.0, 3.0});
    hook.kind = BodyKind::Kinematic;
    hook.twist.w_WB = {0.0, 0.0, spin};
    scene.bodies.push_back(hook);
    scene.bodies.push_back(ball("coupled_to_hook", 0.1, {0.0, 0.0, 0.5}));
    World world = worldOf(scene);
    advance(world, 2.0);
    EXPECT_EQ(std::string(stateOf(world, "coupled_to_hook").method) == "asleep", spin == 0.0) << spin;
  }
}

// In free space: a ball meets one of two that are coupled, and takes both along.
TEST_P(Coupled, AnImpactOnOneMovesBoth) {
  SceneDef scene = emptySpace(kStep);
  scene.bodies.push_back(ball("one", 0.1, Vec3::Zero()));
  scene.bodies.push_back(ball("coupled_to_one", 0.1, {0.0, 5.0, 0.0}));
  BodyDef thrown = ball("thrown", 0.1, {-1.0, 0.0, 0.0});
  thrown.twist.v_WB = {6.0, 0.0, 0.0};
  for (BodyDef& def : scene.bodies) def.mass = 1.0, def.material.restitution = 0.0;
  thrown.mass = 2.0, thrown.material.restitution = 0.0;
  scene.bodies.push_back(thrown);
  World world = worldOf(scene);
  const Vec3 momentum = world.totals().momentum;
  advance(world, 1.0);
  EXPECT_LE((world.totals().momentum - momentum).norm(), 1e-12 * momentum.norm());
  EXPECT_LE((stateOf(world, "one").twist.v_WB - stateOf(world, "coupled_to_one").twist.v_WB).norm(), 1e-9);
  EXPECT_GT(stateOf(world, "coupled_to_one").twist.v_WB.x(), 1.0);
}

// Two swings beside a stack: copies and resumed states have equal futures, and the stack does not see the swings.
TEST_P(Coupled, CopiesAndResumedStatesGoOnAlike) {
  SceneDef scene = onFloor(kStep, 0.5);
  for (int k = 0; k < 3; ++k)
    scene.bodies.push_back(box("box" + std::to_string(k), Vec3::Constant(0.2), {0.0, 0.0, 0.1 + 0.2 * k}));
  const SceneDef alone = scene;
  scene.bodies.push_back(post("post", {3.0, 0.0, 3.0}));
  for (const char* on : {"post", "coupled_to_post"})
    scene.bodies.push_back(
        ball(std::string("coupled_to_") + on, 0.1, {4.0, 0.0, 1.0 + 0.5 * std::string(on).size()}));
  World world = worldOf(scene), stack = worldOf(alone);
  for (int k = 0; k < 30; ++k) world.step(), stack.step();
  World copy = world, resumed(world.capture(), world.captureExactState());
  for (int k = 0; k < 30; ++k) {
    world.step(), copy.step(), resumed.step(), stack.step();
    ASSERT_EQ(world.stateHash(), copy.stateHash()) << k;
    ASSERT_EQ(world.stateHash(), resumed.stateHash()) << k;
  }
  EXPECT_EQ(stateOf(world, "box2").pose.p_WB, stateOf(stack, "box2").pose.p_WB);
}

TEST_P(Coupled, IslandsOfThemAreReported) {
  SceneDef scene = onFloor(kStep, 0.5);
  scene.bodies.push_back(post("post", {2.0, 0.0, 3.0}));
  scene.bodies.push_back(ball("coupled_to_post", 0.1, {0.0, 0.0, 1.0}));
  World world = worldOf(scene);
  const StepReport& report = world.step();
  ASSERT_EQ(report.residuals.size(), 1u);
  EXPECT_STREQ(report.residuals[0].method, "soft_step") << "the exact step does not know them";
  EXPECT_EQ(report.residuals[0].bodies, 1u);
}

INSTANTIATE_TEST_SUITE_P(Settings, Coupled,
                         testing::Values(Fidelity::Preview, Fidelity::Interactive, Fidelity::Accurate),
                         [](const auto& info) { return std::string(fidelityName(info.param)); });

}  // namespace

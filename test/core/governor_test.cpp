// SPDX-License-Identifier: BSD-3-Clause
// A governor keeps a goal, says why, and repeats itself.
#include "make_scene.h"

#include "rigid_body_sim/governor.h"

#include <gmock/gmock.h>

using namespace rbs;
using namespace rbs::test;
using testing::AllOf;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;

namespace {

// Boxes that slide for ever: the soft step is wrong about them in every window.
SceneDef sliding() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.gravity = slopeGravity(0.7);
  for (int k = 0; k < 3; ++k) {
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3(1.0, 1.0, 0.2), Vec3(0.0, 2.0 * k, 0.1)));
    scene.bodies.back().material.friction = 0.5;
  }
  return scene;
}

void run(Governor& governor, World& world, double seconds) {
  const auto steps = static_cast<int>(std::lround(seconds / world.scene().step));
  for (int k = 0; k < steps; ++k) governor.step(world);
}

// The same with a box on each: what slides alone is exact at `interactive`.
SceneDef slidingInPairs() {
  SceneDef scene = sliding();
  for (int k = 0; k < 3; ++k) {
    scene.bodies.push_back(box("on_" + std::to_string(k), Vec3(1.0, 1.0, 0.2), Vec3(0.0, 2.0 * k, 0.3)));
    scene.bodies.back().material.friction = 0.5;
  }
  return scene;
}

TEST(Governor, WithoutAGoalTheWorldGoesItsWay) {
  World world(sliding()), governed(world);
  Governor governor;
  run(governor, governed, 1.0);
  advance(world, 1.0);
  EXPECT_EQ(world.stateHash(), governed.stateHash());
  EXPECT_FALSE(governor.estimate());
  EXPECT_EQ(governor.reason(world), "");
}

TEST(Governor, EstimatingChangesNothingInTheWorld) {
  World world(sliding()), governed(world);
  Governor governor;
  governor.setEstimating(true);
  run(governor, governed, 1.0);
  advance(world, 1.0);
  EXPECT_EQ(world.stateHash(), governed.stateHash());
  ASSERT_TRUE(governor.estimate());
  EXPECT_EQ(governor.estimate()->setting, Setting(Fidelity::Interactive));
  EXPECT_EQ(governor.estimate()->beside.divisions, 2u);
  EXPECT_NEAR(governor.estimate()->window, 0.25, 1e-12);
  EXPECT_GT(governor.estimate()->error.distance, 0.0);
  governor.setEstimating(false);
  governor.step(governed);
  EXPECT_FALSE(governor.estimate());
}

// The estimate over the error of a closed form, at `preview` with so many sub-steps: sliding down from where it is
// with v, x = v t + g (sin a - mu cos a) t²/2.
double estimateOverError(std::uint32_t sub_steps) {
  SceneDef scene = sliding();
  scene.fidelity = Fidelity::Preview;
  scene.fidelity.sub_steps = sub_steps;
  World world(scene);
  Governor governor;
  governor.setEstimating(true);
  run(governor, world, 0.5);
  const Vec3 p = stateOf(world, "box_0").pose.p_WB, v = stateOf(world, "box_0").twist.v_WB;
  run(governor, world, 0.25);
  const double t = governor.estimate()->window;
  const double a = kGravity * (std::sin(0.7) - 0.5 * std::cos(0.7));
  const double exact = p.x() + v.x() * t + 0.5 * a * t * t;
  const double error = std::abs(stateOf(world, "box_0").pose.p_WB.x() - exact) / t;
  return governor.estimate()->error.distance / error;
}

// The error is proportional to the sub-step, so that the second run, with half of it, is off by half as much.
TEST(Governor, TheEstimateIsHalfTheErrorOfAClosedForm) {
  for (const std::uint32_t sub_steps : {1u, 2u, 4u, 8u, 16u})
    EXPECT_THAT(estimateOverError(sub_steps), AllOf(Ge(0.5), Le(0.5 + 0.25 / sub_steps))) << sub_steps;
}

TEST(Governor, WhoStopsEstimatingHasNoEstimateAnyMore) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(box("box", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  scene.goal = Goal{};
  scene.goal->max_step_ms = 1000.0;
  World world(scene);
  Governor governor;
  governor.setEstimating(true);
  for (int k = 0; k < 20; ++k) governor.step(world);
  EXPECT_TRUE(governor.estimate());
  governor.setEstimating(false);
  governor.step(world);
  EXPECT_FALSE(governor.estimate());
}

TEST(Governor, AGoalOfErrorClimbsUntilItIsMetAndSaysWhy) {
  SceneDef scene = slidingInPairs();
  scene.fidelity = Fidelity::Preview;
  scene.goal = Goal{1e-6, std::nullopt};
  World world(scene);
  Governor governor;
  run(governor, world, 2.0);
  EXPECT_EQ(world.scene().fidelity, Setting(Fidelity::Accurate));
  EXPECT_THAT(governor.reason(world), HasSubstr("accurate: interactive, 32 sub-steps has an error of"));
  EXPECT_THAT(governor.reason(world), HasSubstr("mm/s, which is above 0.001 mm/s"));
  EXPECT_LE(governor.estimate()->error.distance, 1e-6);
}

TEST(Governor, TheReasonGoesWithTheGoal) {
  SceneDef scene = sliding();
  scene.fidelity = Fidelity::Preview;
  scene.goal = Goal{1e-6, std::nullopt};
  World world(scene);
  Governor governor;
  run(governor, world, 2.0);
  ASSERT_NE(governor.reason(world), "");
  world.setGoal(Goal{1e-3, std::nullopt});
  EXPECT_EQ(governor.reason(world), "");
  governor.step(world);
  EXPECT_EQ(governor.reason(world), "");
  world.setGoal(Goal{1e-6, std::nullopt});
  world.setFidelity(Fidelity::Preview);
  run(governor, world, 2.0);
  ASSERT_NE(governor.reason(world), "");
  world.setGoal(std::nullopt);
  EXPECT_EQ(governor.reason(world), "");
}

// Every new reason is logged.
TEST(Governor, AGoalOutOfReachHasOneReasonHoweverOftenItIsMissed) {
  for (const Goal& goal : {Goal{1e-12, std::nullopt}, Goal{std::nullopt, 1e-9}}) {
    SceneDef scene = sliding();
    scene.air = Air{};
    scene.fidelity = Fidelity::Reference;
    scene.fidelity.divisions = 8;
    scene.goal = goal;
    World world(scene);
    Governor governor;
    run(governor, world, 4.0);
    const std::string reason = governor.reason(world);
    ASSERT_THAT(reason, HasSubstr("settings, although"));
    for (int window = 0; window < 8; ++window) {
      run(governor, world, 0.25);
      EXPECT_EQ(governor.reason(world), reason);
    }
  }
}

TEST(Governor, AGoalOfErrorComesDownWhereLessWillDo) {
  SceneDef scene = sliding();
  scene.fidelity = Fidelity::Reference;
  scene.fidelity.divisions = 8;
  scene.goal = Goal{10.0, std::nullopt};
  World world(scene);
  Governor governor;
  run(governor, world, 10.0);
  EXPECT_EQ(world.scene().fidelity, Setting(Fidelity::Preview));
  EXPECT_THAT(governor.reason(world), HasSubstr("is well below 10000 mm/s"));
}

// In wind all settings of one step are wrong alike. The error by a closed form does not exist, so a finer
// run is the judge.
TEST(Governor, AGoalOfErrorSeesWhatGoesWithTheStepAlone) {
  SceneDef scene;
  scene.step = 1.0 / 60.0;
  scene.gravity.setZero();
  scene.air = Air{};
  scene.air->density = 1.2;
  scene.wind = Wind{};
  scene.wind->velocity = Vec3(20.0, 0.0, 0.0);
  scene.wind->gust = 10.0;
  scene.bodies.push_back(box("sail", Vec3(1.6, 1.2, 0.02), Vec3::Zero()));
  scene.bodies.back().density = 20.0;
  scene.fidelity = Fidelity::Interactive;
  scene.goal = Goal{2e-5, std::nullopt};
  World world(scene);
  Governor governor;
  run(governor, world, 2.0);
  for (int window = 0; window < 4; ++window) {
    World fine(world);
    Setting judge(Fidelity::Reference);
    judge.divisions = 64;
    fine.setFidelity(judge);
    fine.setGoal(std::nullopt);
    const Setting setting = world.scene().fidelity;
    run(governor, world, 0.25);
    advance(fine, 0.25);
    const double error = (stateOf(world, "sail").pose.p_WB - stateOf(fine, "sail").pose.p_WB).norm() / 0.25;
    EXPECT_LE(error, 1.2 * scene.goal->max_error.value()) << settingName(setting);
  }
}

// A setting that is no rung moves to the next rung that is no less exact, or no more, in any of its numbers.
TEST(Governor, ASettingBesideTheLadderFindsItsPlace) {
  const auto turned = [](const Setting& from, const Goal& goal) {
    SceneDef scene = sliding();
    scene.air = Air{};
    scene.fidelity = from;
    scene.goal = goal;
    World world(scene);
    Governor governor;
    run(governor, world, 0.25);
    return world.scene().fidelity;
  };
  const auto with = [](Fidelity preset, std::uint32_t divisions, std::optional<std::uint32_t> sub_steps = {},
                       std::optional<double> tolerance = {}) {
    Setting setting(preset);
    setting.divisions = divisions, setting.sub_steps = sub_steps, setting.tolerance = tolerance;
    return setting;
  };
  const Goal exact{1e-12, std::nullopt}, fast{std::nullopt, 1e-9};
  EXPECT_EQ(turned(with(Fidelity::Reference, 1), fast), with(Fidelity::Accurate, 1));
  EXPECT_EQ(turned(with(Fidelity::Preview, 8), fast), with(Fidelity::Preview, 1));
  EXPECT_EQ(turned(with(Fidelity::Accurate, 1, {}, 1e-3), fast), with(Fidelity::Interactive, 1, 32));
  EXPECT_EQ(turned(with(Fidelity::Preview, 1, 1), fast), with(Fidelity::Preview, 1, 1));
  EXPECT_EQ(turned(with(Fidelity::Preview, 1, 1), exact), with(Fidelity::Preview, 1));
  EXPECT_EQ(turned(with(Fidelity::Interactive, 1, 16), exact), with(Fidelity::Interactive, 1, 32));
  EXPECT_EQ(turned(with(Fidelity::Interactive, 1, 8), exact), with(Fidelity::Interactive, 1, 32));
  EXPECT_EQ(turned(with(Fidelity::Preview, 8), exact), with(Fidelity::Reference, 8));
  EXPECT_EQ(turned(with(Fidelity::Accurate, 1, {}, 1e-3), exact), with(Fidelity::Accurate, 1));
}

TEST(Governor, AGoalOfErrorRepeatsItself) {
  const auto hash = [] {
    SceneDef scene = sliding();
    scene.goal = Goal{1e-4, std::nullopt};
    World world(scene);
    Governor governor;
    run(governor, world, 3.0);
    return world.stateHash();
  };
  EXPECT_EQ(hash(), hash());
}

TEST(Governor, TurningTheDialMakesNoJump) {
  SceneDef scene = slidingInPairs();
  scene.fidelity = Fidelity::Preview;
  scene.goal = Goal{1e-6, std::nullopt};
  World world(scene);
  Governor governor;
  Setting before = world.scene().fidelity;
  int turns = 0;
  for (int k = 0; k < 120; ++k) {
    const BodyState then = stateOf(world, "box_1");
    governor.step(world);
    const BodyState now = stateOf(world, "box_1");
    EXPECT_LE((now.pose.p_WB - then.pose.p_WB - then.twist.v_WB / 60.0).norm(), kGravity / 3600.0);
    EXPECT_LE((now.twist.v_WB - then.twist.v_WB).norm(), 1.01 * kGravity / 60.0);
    turns += world.scene().fidelity != before;
    before = world.scene().fidelity;
  }
  EXPECT_GE(turns, 1);
}

TEST(Governor, AnEditBeginsTheWindowAnew) {
  World world(sliding());
  Governor governor;
  governor.setEstimating(true);
  for (int k = 0; k < 100; ++k) {
    if (k % 10 == 0) world.applyImpulse(world.find("box_0"), Vec3(0.0, 0.0, 1.0), Vec3::Zero());
    governor.step(world);
  }
  EXPECT_FALSE(governor.estimate()) << "no window was ever over";
  world.removeBody(world.find("box_0"));
  run(governor, world, 0.5);
  EXPECT_TRUE(governor.estimate());
}

// Also in the window in which the rung below is tried: there is none below the first.
TEST(Governor, TheDialMayBePutAnywhereMeanwhile) {
  for (int windows = 1; windows <= 6; ++windows) {
    SceneDef scene = sliding();
    scene.fidelity = Fidelity::Accurate;
    scene.goal = Goal{10.0, std::nullopt};
    World world(scene);
    Governor governor;
    run(governor, world, 0.25 * windows);
    world.setFidelity(Fidelity::Preview);
    run(governor, world, 0.5);
    EXPECT_EQ(world.scene().fidelity, Setting(Fidelity::Preview));
    ASSERT_TRUE(governor.estimate());
    EXPECT_EQ(governor.estimate()->beside.preset, Fidelity::Interactive) << windows;
    EXPECT_EQ(governor.estimate()->beside.divisions, 2u) << windows;
  }
}

TEST(Governor, AGoalOfTimeGoesDownAndUpTheLadder) {
  SceneDef scene = sliding();
  scene.fidelity = Fidelity::Accurate;
  scene.goal = Goal{std::nullopt, 1e-9};
  World world(scene);
  Governor governor;
  run(governor, world, 2.0);
  EXPECT_EQ(world.scene().fidelity, Setting(Fidelity::Preview));
  EXPECT_THAT(governor.reason(world), HasSubstr("the fastest settings, although"));
  world.setGoal(Goal{std::nullopt, 1e5});
  run(governor, world, 40.0);
  EXPECT_EQ(world.scene().fidelity.preset, Fidelity::Reference);
}

}  // namespace

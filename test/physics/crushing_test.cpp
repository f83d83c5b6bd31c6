// SPDX-License-Identifier: BSD-3-Clause
// Heavy bodies that fall on light thin ones, close above a thin slab: nothing comes out on its other side.
#include "make_scene.h"

#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

class Crushing : public ::testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, Crushing, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return fidelityName(info.param); });

constexpr double kPlate = 0.01, kSlab = 0.02;  // m, thickness

// Two plates, one on the other, 50 mm above a slab, and a ball that is about to strike them.
SceneDef platesAndBall(double speed, double mass_ratio) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(box("slab", {4.0, 4.0, kSlab}, {0.0, 0.0, -0.5 * kSlab}));
  scene.bodies.back().kind = BodyKind::Static;
  for (const int k : {0, 1})
    scene.bodies.push_back(
        box("plate_" + std::to_string(k), {0.4, 0.4, kPlate}, {0.0, 0.0, 0.05 + (k + 0.5) * kPlate}));
  const double plate = 1000.0 * 0.4 * 0.4 * kPlate, radius = 0.1;
  scene.bodies.push_back(ball("ball", radius, {0.02, 0.03, 0.05 + 2.0 * kPlate + radius + 1e-3}));
  scene.bodies.back().mass = mass_ratio * plate;
  scene.bodies.back().twist.v_WB.z() = -speed;
  return scene;
}

// The lower plate is at rest and 50 mm from the slab, so no prediction of its own motion meets it. The plate above
// pushes it there within the step, and, at these speeds, through it and out on the other side. At the fast settings the step
// begins again then; at the exact ones the plates only go back to when the lower one met the slab.
TEST_P(Crushing, APlateIsNotPushedThroughWhatItsOwnMotionWouldNotHaveMet) {
  for (const double speed : {5.0, 10.0, 20.0, 40.0}) {
    SceneDef scene = platesAndBall(speed, 5.0);
    scene.fidelity = GetParam();
    World world(scene);
    std::uint32_t repeated = 0;
    for (int k = 0; k < 30; ++k) {
      repeated += world.step().repeated;
      for (const char* name : {"plate_0", "plate_1", "ball"})
        EXPECT_GT(stateOf(world, name).pose.p_WB.z(), -0.5 * kSlab)
            << name << ", " << speed << " m/s, step " << k;
    }
    if (GetParam() < Fidelity::Accurate) EXPECT_GT(repeated, 0u) << speed << " m/s";
  }
}

// As above, with cubes above a plane, which itself stops a body only at half of its size.
TEST_P(Crushing, ACubeIsNotPushedIntoAPlaneThatItsOwnMotionWouldNotHaveMet) {
  if (GetParam() == Fidelity::Preview) GTEST_SKIP() << "it sinks in by up to 0.46 of its size";
  constexpr double kSize = 0.2, kRadius = 0.1;
  for (const double gap : {0.05, 0.1})
    for (const double speed : {2.0, 5.0, 10.0})
      for (const double ratio : {5.0, 50.0}) {
        SceneDef scene = emptySpace(1.0 / 60.0);
        scene.fidelity = GetParam();
        scene.bodies.push_back(floorOf(0.5));
        for (const int k : {0, 1}) {
          scene.bodies.push_back(
              box("cube_" + std::to_string(k), {0.4, 0.4, kSize}, {0.0, 0.0, gap + (k + 0.5) * kSize}));
          scene.bodies.back().mass = 32.0;
        }
        scene.bodies.push_back(ball("ball", kRadius, {0.02, 0.03, gap + 2.0 * kSize + kRadius + 1e-3}));
        scene.bodies.back().mass = 32.0 * ratio;
        scene.bodies.back().twist.v_WB.z() = -speed;
        for (const SceneDef& in_order : inBothOrders(scene)) {
          World world(in_order);
          double lowest = 1.0;
          for (int k = 0; k < 30; ++k) {
            world.step();
            for (const char* name : {"cube_0", "cube_1"})
              lowest = std::min(lowest, stateOf(world, name).pose.p_WB.z());
          }
          EXPECT_GT(lowest, 0.47 * kSize) << gap << " m above, " << speed << " m/s, 1 : " << ratio;
        }
      }
}

// By the step of interactive each sub-step would carry the impulse one contact further, and the ball through both
// plates meanwhile.
TEST_P(Crushing, AHeavyBodyIsStoppedThroughLightOnes) {
  if (GetParam() == Fidelity::Preview) GTEST_SKIP() << "it has no exact step: docs/stability.md";
  for (const double ratio : {20.0, 100.0, 1000.0}) {
    SceneDef scene = platesAndBall(20.0, ratio);
    scene.fidelity = GetParam();
    World world(scene);
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const char* name : {"plate_0", "plate_1", "ball"})
        ASSERT_GT(stateOf(world, name).pose.p_WB.z(), -0.5 * kSlab)
            << name << ", 1 : " << ratio << ", step " << k;
    }
  }
}

// With restitution the light body rattles between the two, and some of its impacts are left to the contact solver. It was
// pressed flat, or through the slab, in the step of the blow.
TEST_P(Crushing, ALightBodyThatRattlesUnderAHeavyOneStaysAboveTheFloor) {
  if (GetParam() == Fidelity::Preview) GTEST_SKIP() << "it has no exact step: docs/stability.md";
  constexpr double kSize = 0.02;
  struct Blow {
    double ratio, speed, step;
  };
  for (const double restitution : {0.01, 0.1, 0.3, 0.5, 0.8})
    for (const double gravity : {0.0, kGravity})
      for (const double slab : {0.01, 0.05})
        for (const bool is_ball : {false, true})
          for (const auto& [ratio, speed, step] : {Blow{30.0, 5.0, 1.0 / 60.0},
                                                   {20.0, 5.0, 1.0 / 60.0},
                                                   {30.0, 5.0, 1.0 / 240.0},
                                                   {100.0, 3.0, 1.0 / 60.0}}) {
            SceneDef scene = emptySpace(step);
            scene.gravity.z() = -gravity;
            scene.fidelity = GetParam();
            scene.bodies.push_back(box("slab", {2.0, 2.0, slab}, {0.0, 0.0, -0.5 * slab}));
            scene.bodies.back().kind = BodyKind::Static;
            scene.bodies.push_back(is_ball ? ball("light", 0.5 * kSize, {0.0, 0.0, 0.5 * kSize})
                                           : box("light", {kSize, kSize, kSize}, {0.0, 0.0, 0.5 * kSize}));
            scene.bodies.back().mass = 1.0;
            scene.bodies.push_back(box("heavy", {0.1, 0.1, 0.1}, {0.0, 0.0, 0.12}));
            scene.bodies.back().mass = ratio;
            scene.bodies.back().twist.v_WB.z() = -speed;
            for (BodyDef& body : scene.bodies) body.material.restitution = restitution;
            World world(ordered(scene));
            double lowest = 1.0;
            for (int k = 0; k < 30; ++k) {
              world.step();
              lowest = std::min(lowest, stateOf(world, "light").pose.p_WB.z());
            }
            EXPECT_GT(lowest, (GetParam() == Fidelity::Interactive ? 0.47 : 0.49) * kSize)  // 0.484
                << "e " << restitution << ", gravity " << gravity << ", slab of " << slab
                << " m, 1 : " << ratio << ", step " << step;
          }
}

constexpr double kCreep = 0.02, kSpeed = 3.9;  // m/s: of two cubes, which stay awake so, and of a slider

// A slider pushes two cubes, 15 mm before a body that sleeps, into it within the step after 1 s, at this share of it.
// Or the sleeper lies elsewhere.
SceneDef sliderCubesAndSleeper(Fidelity setting, double share, double sleeper_y = 0.0) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.0);
  scene.fidelity = setting;
  scene.effects[Effect::Sleeping] = true;
  const auto add = [&](const char* name, double size, double mass, double front, double v) {
    BodyDef def = box(name, {size, size, size}, {front - 0.5 * size, 0.0, 0.5 * size});
    def.mass = mass, def.material.friction = 0.0, def.twist.v_WB.x() = v;
    scene.bodies.push_back(def);
  };
  const double met = 1.0 + share * scene.step, cubes = -0.015 - met * kCreep;
  add("sleeper", 0.3, 27.0, 0.3, 0.0);
  scene.bodies.back().pose.p_WB.y() = sleeper_y;
  add("near", 0.1, 2.0, cubes, kCreep);
  add("far", 0.1, 2.0, cubes - 0.1, kCreep);
  add("slider", 0.2, 100.0, cubes - 0.2 - met * (kSpeed - kCreep), kSpeed);
  return scene;
}

bool isAsleep(const World& world, const char* name) {
  return std::string(stateOf(world, name).method) == "asleep";
}

// It wakes, and takes its share of the momentum: a body that slept on would be a wall.
TEST_P(Crushing, AMissedSleeperWakesAndTakesItsMomentum) {
  for (const double share : {0.1, 0.3, 0.5, 0.7}) {
    World world(sliderCubesAndSleeper(GetParam(), share));
    advance(world, 0.95);
    ASSERT_TRUE(isAsleep(world, "sleeper"));
    const double before = world.totals().momentum.x();
    for (int k = 0; k < 12; ++k) {
      world.step();
      EXPECT_NEAR(world.totals().momentum.x(), before, 1e-9 * before) << "share " << share << ", step " << k;
    }
    EXPECT_GT(stateOf(world, "sleeper").twist.v_WB.x(), 1.0) << "share " << share;
  }
}

// A step that begins again, since a sleeper has woken in it, is the step that it would have been with that body awake:
// a ball far away, which lands in that step, takes the same course, bit for bit.
TEST_P(Crushing, ASleeperThatWakesWithinAStepChangesNothingFarAway) {
  BodyDef lands = ball("lands", 0.1, {0.0, -50.0, 1.225});
  lands.twist.v_WB = {1.0, 0.0, 3.81};
  std::vector<Pose> ends;
  for (const double y : {20.0, 0.0}) {
    SceneDef scene = sliderCubesAndSleeper(GetParam(), 0.3, y);
    scene.bodies.push_back(lands);
    World world(scene);
    advance(world, 1.0);
    EXPECT_TRUE(isAsleep(world, "sleeper"));
    EXPECT_GT(stateOf(world, "lands").pose.p_WB.z(), 0.11);
    world.step();
    EXPECT_EQ(isAsleep(world, "sleeper"), y > 0.0);
    EXPECT_LT(stateOf(world, "lands").pose.p_WB.z(), 0.11);
    for (int k = 0; k < 3; ++k) world.step();
    ends.push_back(stateOf(world, "lands").pose);
  }
  EXPECT_EQ(ends[0].p_WB, ends[1].p_WB);
  EXPECT_EQ(ends[0].q_WB.coeffs(), ends[1].q_WB.coeffs());
}

// A body that gravity alone moves, and that leaves the limits in a step that begins again, is frozen and named by the
// step as it was taken in the end.
TEST_P(Crushing, WhatLeavesTheLimitsInAStepThatBeginsAgainIsNamed) {
  SceneDef scene = sliderCubesAndSleeper(GetParam(), 0.3);
  BodyDef lost = ball("lost", 0.1, {0.0, 0.0, 0.0});
  lost.mask = 0, lost.twist.v_WB.x() = 1e4;
  lost.pose.p_WB.x() = Limits::max_position - lost.twist.v_WB.x() * (1.0 + 0.5 * scene.step);
  scene.bodies.push_back(lost);
  World world(scene);
  advance(world, 1.0);
  ASSERT_TRUE(isAsleep(world, "sleeper"));
  ASSERT_STREQ(stateOf(world, "lost").method, "ballistic");
  const Vec3 last = stateOf(world, "lost").pose.p_WB;
  const std::vector<Warning> warnings = world.step().warnings;
  ASSERT_FALSE(isAsleep(world, "sleeper"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].kind, "non_finite");
  EXPECT_EQ(stateOf(world, "lost").pose.p_WB, last);
  EXPECT_TRUE(stateOf(world, "lost").twist.v_WB.isZero(0.0));
}

// A ball, 30 mm before a body that sleeps, flies off towards a wall and comes back in the same step. Its predicted motion
// does not meet the sleeper, and no other body is awake.
TEST_P(Crushing, ASleeperThatABallMeetsOnItsWayBackTakesItsMomentum) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.0);
  scene.fidelity = GetParam();
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("sleeper", {0.3, 0.3, 0.3}, {0.15, 0.0, 0.15}));
  scene.bodies.push_back(box("wall", {0.2, 2.0, 2.0}, {0.9, 0.0, 1.0}));
  scene.bodies.back().kind = BodyKind::Static;
  World calm(scene);
  advance(calm, 2.0);
  SceneDef now = calm.capture();
  BodyDef thrown = ball("ball", 0.05, {0.38, 0.0, 0.15});
  thrown.mass = 1.0, thrown.twist.v_WB.x() = 50.0;
  now.bodies.push_back(thrown);
  for (BodyDef& body : now.bodies) body.material.friction = 0.0, body.material.restitution = 1.0;
  World world(now, calm.captureState());
  ASSERT_TRUE(isAsleep(world, "sleeper"));
  world.step();
  EXPECT_NEAR(world.totals().momentum.x(), -50.0, 1e-9);
  EXPECT_LT(stateOf(world, "sleeper").twist.v_WB.x(), -1.0);
}

// What parts bodies that slide past each other shifts them, and their spin makes up for the angular momentum of that. It
// takes no more at each of the three contacts than its bodies have against each other: two balls of 1 g got 5 kJ once.
TEST_P(Crushing, SmallBallsBetweenHeavyBodiesArePartedWithinTheirEnergy) {
  constexpr double kRadius = 0.005;
  for (const double overlap : {1e-6, 1e-5, 1e-4, 1e-3}) {
    SceneDef scene = emptySpace(1.0 / 60.0);
    scene.gravity.setZero();
    scene.fidelity = GetParam();
    for (const double side : {-1.0, 1.0}) {
      const std::string name = side < 0.0 ? "_left" : "_right";
      scene.bodies.push_back(
          box("box" + name, {1.0, 1.0, 1.0}, {side * (2.0 * kRadius - 1.5 * overlap + 0.5), 0.0, 0.0}));
      scene.bodies.push_back(ball("ball" + name, kRadius, {side * (kRadius - 0.5 * overlap), 0.0, 0.0}));
      scene.bodies.back().twist.v_WB.y() = 0.5 * side;
    }
    for (BodyDef& body : scene.bodies) body.material.friction = 0.5;
    World world(scene);
    const double before = world.totals().kinetic_energy;
    for (int k = 0; k < 3; ++k) {
      world.step();
      EXPECT_LE(world.totals().kinetic_energy, 4.0 * before) << "overlap " << overlap << ", step " << k;
    }
  }
}

// The forces of the exact step, 508 N on a rod of 5 g, are no good guess for sub-steps, in which it turns by up to 0.5 rad:
// what they left in it made 5e10 times the energy of all bodies in a step. In five steps the heavy bodies fall for 10 %.
TEST(SoftStep, ARodThatIsSqueezedGainsNoEnergyAtAnyNumberOfSubSteps) {
  const SceneFile file = readScene(RBS_SCENES "/../test/physics/squeezed_rod.yaml");
  for (const Fidelity preset : {Fidelity::Preview, Fidelity::Interactive})
    for (const unsigned n : {2u, 6u, 12u, 40u})
      for (const double part : {1.0, 0.25})
        for (const double mass : {1.0, 0.1})
          for (const double spin : {0.3, 1.0}) {
            SceneDef scene = file.scene;
            scene.fidelity = preset, scene.fidelity.sub_steps = n, scene.step *= part;
            BodyDef& rod = scene.bodies[2];
            rod.twist.w_WB *= spin, rod.mass = mass * *rod.mass;
            World world(scene, file.state);
            const double before = world.totals().kinetic_energy;
            for (int k = 0; k < 5; ++k) {
              world.step();
              EXPECT_LT(world.totals().kinetic_energy, 1.2 * before)
                  << fidelityName(preset) << ", " << n << " sub-steps of a step of " << scene.step
                  << " s, spin times " << spin << ", mass times " << mass;
            }
          }
}

// A solve that went wrong made up to 1,500 times the energy in a step: what a segment may gain was bounded only where no
// kinematic body and no torque could have given it. Such a slab at 1 m/s gives the disc some.
TEST(ExactStep, ADiscWedgedBesideAKinematicSlabGainsNoEnergy) {
  const SceneDef wedged = readScene(RBS_SCENES "/../test/physics/wedged_disc.yaml").scene;
  struct Slab {
    BodyKind kind;
    double speed, torque;  // m/s; N m, on the disc
  };
  for (const Fidelity setting : {Fidelity::Interactive, Fidelity::Accurate, Fidelity::Reference})
    for (const Slab& slab : {Slab{BodyKind::Kinematic, 0.0, 0.0}, Slab{BodyKind::Kinematic, 0.1, 0.0},
                             Slab{BodyKind::Kinematic, 1.0, 0.0}, Slab{BodyKind::Static, 0.0, 1e-6}})
      for (unsigned start = 0; start < 12; ++start) {
        SceneDef scene = wedged;
        scene.fidelity = setting;
        scene.bodies[0].kind = slab.kind;
        scene.bodies[0].twist.v_WB = slab.speed * Vec3(0.6, 0.8, 0.0);
        std::mt19937_64 random(start);
        std::uniform_real_distribution<> off(-1e-5, 1e-5);
        for (BodyDef& body : scene.bodies)
          if (body.kind == BodyKind::Dynamic) body.pose.p_WB += Vec3(off(random), off(random), off(random));
        World world(scene);
        const BodyId disc = world.find("body_1");
        if (slab.torque > 0.0)
          world.applyWrench(disc, Vec3::Zero(), slab.torque * Vec3::UnitX(), world.pose(disc).p_WB, 1.0);
        const double before = energy(world);
        world.step();
        EXPECT_LE(energy(world), before) << fidelityName(setting) << ", slab at " << slab.speed
                                         << " m/s, torque " << slab.torque << ", start " << start;
      }
}

// Two plates, one on the other, that a heavy ball strikes from above, and a ball that comes from below to meet the lower
// one, which no prediction of its own motion sees. What also comes has its impact at another time, and is the oldest
// body or the youngest but one.
SceneDef platesBetweenBalls(Fidelity setting, double down, double up, double restitution, const BodyDef* also,
                            bool oldest) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.fidelity = setting;
  if (also && oldest) scene.bodies.push_back(*also);
  BodyDef from_below = ball("from_below", 0.1, {0.0, 0.0, also ? -0.101 : -0.112});
  from_below.twist.v_WB.z() = up, from_below.material.restitution = restitution;
  if (!also && oldest) scene.bodies.push_back(from_below);
  for (const int k : {0, 1})
    scene.bodies.push_back(
        box("plate_" + std::to_string(k), {0.4, 0.4, kPlate}, {0.0, 0.0, (k + 0.5) * kPlate}));
  scene.bodies.push_back(ball("heavy", 0.1, {0.0, 0.0, 2.0 * kPlate + 0.101}));
  scene.bodies.back().mass = 100.0, scene.bodies.back().twist.v_WB.z() = -down;
  if (also && !oldest) scene.bodies.push_back(*also);
  if (also || !oldest) scene.bodies.push_back(from_below);
  return scene;
}

// The heavy ball is brought to its impact together with the plates, and so is the ball from below to its own: which island is
// the first of the two says nothing of where the plate and the ball meet.
TEST(EarlyMeetings, DoNotDependOnTheOrderOfTheBodies) {
  for (const Fidelity setting : {Fidelity::Accurate, Fidelity::Reference})
    for (const double restitution : {0.0, 0.5, 1.0})
      for (const double down : {1.0, 3.0, 10.0})
        for (const double up : {0.5, 1.0, 2.0}) {
          std::vector<double> speeds;
          for (const bool oldest : {true, false}) {
            World world(platesBetweenBalls(setting, down, up, restitution, nullptr, oldest));
            for (int k = 0; k < 3; ++k) {
              EXPECT_EQ(world.step().repeated, 0u);
              const double gap = stateOf(world, "plate_0").pose.p_WB.z() - 0.5 * kPlate - 0.1 -
                                 stateOf(world, "from_below").pose.p_WB.z();
              EXPECT_GT(gap, -1e-9) << down << " m/s down, " << up << " m/s up, e = " << restitution;
            }
            speeds.push_back(stateOf(world, "from_below").twist.v_WB.z());
          }
          EXPECT_NEAR(speeds[0], speeds[1], 1e-9 * down);
        }
}

// Another ball strikes the upper plate at a later time than the two meet, and is ahead of them when they go back: they are
// predicted to meet it from there on, and the step does not begin again.
TEST(EarlyMeetings, GoBackBesideABodyThatIsAhead) {
  for (const Fidelity setting : {Fidelity::Accurate, Fidelity::Reference})
    for (const double above : {0.01, 0.015, 0.02, 0.03, 0.1}) {
      BodyDef also = ball("also", 0.02, {0.15, 0.15, 2.0 * kPlate + 0.02 + above});
      also.twist.v_WB.z() = -20.0;
      std::vector<Vec3> speeds;
      for (const bool oldest : {true, false}) {
        World world(platesBetweenBalls(setting, 5.0, 0.1, 0.0, &also, oldest));
        EXPECT_EQ(world.step().repeated, 0u) << above << " m above";
        speeds.push_back({stateOf(world, "from_below").twist.v_WB.z(),
                          stateOf(world, "plate_0").twist.v_WB.z(), stateOf(world, "also").twist.v_WB.z()});
        EXPECT_GT(stateOf(world, "plate_0").pose.p_WB.z() - 0.5 * kPlate - 0.1,
                  stateOf(world, "from_below").pose.p_WB.z() - 1e-9);
      }
      EXPECT_LE((speeds[0] - speeds[1]).norm(), 1e-8);
    }
}

// The island of the second of two that meet in the air and stay together has no bodies left when those in the air are
// looked at, at the end of the step. (Assertions of the standard library find one that is asked for its first body.)
TEST(EarlyMeetings, LookAtNoIslandThatAnotherHasTakenIn) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.air = Air{};
  scene.fidelity = Fidelity::Accurate;
  for (const int k : {0, 1, 2, 3}) {
    BodyDef& flying = scene.bodies.emplace_back(
        ball("ball_" + std::to_string(k), 0.1, {k % 2 * 0.21, 10.0 * (k / 2), 0.0}));
    flying.twist.v_WB.x() = k % 2 == 0 ? 2.0 : -2.0;
    flying.material.restitution = k / 2 == 0 ? 0.0 : 1.0;
  }
  World world(scene);
  EXPECT_EQ(world.step().impacts, 2u);
  EXPECT_NEAR(stateOf(world, "ball_0").twist.v_WB.x(), stateOf(world, "ball_1").twist.v_WB.x(), 1e-3);
  EXPECT_LT(stateOf(world, "ball_2").twist.v_WB.x(), -1.0);
}

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {
    scene.step = std::array{1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0}[seed % 3];
    X_WS_.q_WB = anyTurn();
    X_WS_.p_WB = Vec3(within(-5, 5), within(-5, 5), within(-5, 5));
    scene.gravity = X_WS_.q_WB * Vec3(0.0, 0.0, -kGravity);
    thickness = within(0.005, 0.05);
    const Shape slab =
        seed % 4 == 0 ? Shape(Cylinder{3.0, 0.5 * thickness}) : Shape(Box{{6.0, 6.0, thickness}});
    add(slab, Vec3::Zero(), Quat::Identity(), Vec3::Zero());
    scene.bodies.back().kind = seed % 7 == 0 ? BodyKind::Kinematic : BodyKind::Static;
    double z = 0.5 * thickness + within(0.001, 0.03);
    addLight(z);
    addHeavy(z);
  }

  // How far a point is on the other side of the middle of the slab, m; nothing beside it.
  double below(const Vec3& p_W) const {
    const Vec3 p_S = X_WS_.q_WB.conjugate() * (p_W - X_WS_.p_WB);
    return p_S.head<2>().norm() < 2.5 ? -p_S.z() : 0.0;
  }

  SceneDef scene;
  double thickness;  // of the slab, m

 private:
  double within(double a, double b) { return std::uniform_real_distribution<>(a, b)(random_); }
  Quat anyTurn() {
    std::normal_distribution<> normal;
    return Quat(normal(random_), normal(random_), normal(random_), normal(random_)).normalized();
  }

  // In the frame S of the slab.
  void add(const Shape& shape, const Vec3& p_S, const Quat& q_SB, const Vec3& v_S) {
    BodyDef def = body("body_" + std::to_string(scene.bodies.size()), shape, X_WS_.p_WB + X_WS_.q_WB * p_S);
    def.pose.q_WB = X_WS_.q_WB * q_SB;
    def.twist.v_WB = X_WS_.q_WB * v_S;
    scene.bodies.push_back(def);
  }

  // One to four, one above the other from z on.
  void addLight(double& z) {
    const double fall = within(0.0, 2.0);
    for (unsigned k = 0, n = 1 + random_() % 4; k < n; ++k) {
      const double thick = within(0.002, 0.03);
      const std::array<Shape, 4> shapes{Box{{within(0.1, 0.6), within(0.1, 0.6), thick}},
                                        Cylinder{within(0.05, 0.3), 0.5 * thick},
                                        Capsule{0.5 * thick, within(0.05, 0.3)}, Sphere{0.5 * thick}};
      const unsigned which = random_() % 4;
      const Quat lying(Eigen::AngleAxisd(which == 2 ? 0.5 * kPi : 0.0, Vec3::UnitX()));
      add(shapes[which], {within(-0.1, 0.1), within(-0.1, 0.1), z + 0.5 * thick}, lying,
          {within(-0.2, 0.2), within(-0.2, 0.2), -fall});
      scene.bodies.back().density = within(100.0, 2000.0);
      z += thick + (random_() % 2 == 0 ? 1e-4 : within(0.0, 0.01));
    }
  }

  void addHeavy(double z) {
    for (unsigned k = 0, n = 1 + random_() % 3; k < n; ++k) {
      const std::array<Shape, 5> shapes{
          Sphere{within(0.05, 0.2)}, Box{{within(0.1, 0.4), within(0.1, 0.4), within(0.1, 0.4)}},
          Cylinder{within(0.05, 0.2), within(0.05, 0.2)}, Cone{within(0.05, 0.2), within(0.1, 0.4)},
          Capsule{within(0.05, 0.15), within(0.05, 0.2)}};
      add(shapes[random_() % 5], {within(-0.15, 0.15), within(-0.15, 0.15), z + within(0.35, 0.7) + 0.8 * k},
          anyTurn(), {within(-1.0, 1.0), within(-1.0, 1.0), -within(2.0, 25.0)});
      scene.bodies.back().density = within(1000.0, 8000.0);
      scene.bodies.back().twist.w_WB = Vec3(within(-3.0, 3.0), within(-3.0, 3.0), within(-3.0, 3.0));
    }
  }

  std::mt19937_64 random_;
  Pose X_WS_;
};

// At `reference` scene 205 got 4.7 times its energy from a solve that had not found the forces. The solves of 91 and 154
// take more work than a step may: what the soft step pushed through the slab instead was not looked for. In one of 31 starts
// of 91 that are off by 1e-13 m something still goes through, so each of these three has three starts.
// At the soft settings something goes through in one scene of 200 or 300 (docs/stability.md).
TEST_P(Crushing, NothingGoesThroughAThinSlabOrGainsEnergy) {
  const bool soft = GetParam() == Fidelity::Preview || GetParam() == Fidelity::Interactive;
  const auto goesThrough = [&](unsigned seed, double shift) {
    RandomScene random(seed);
    random.scene.fidelity = GetParam();
    for (BodyDef& def : random.scene.bodies)
      if (def.kind == BodyKind::Dynamic) def.pose.p_WB.x() += shift;
    World world(random.scene);
    const double at_start = energy(world), scale = world.totals().kinetic_energy;
    double deepest = 0.0, gain = 0.0;
    for (int k = 0; k * random.scene.step < 0.67; ++k) {
      world.step();
      gain = std::max(gain, energy(world) - at_start);
      for (const BodyState& state : world.snapshot().states)
        deepest = std::max(deepest, random.below(state.pose.p_WB));
    }
    EXPECT_LT(gain, 0.02 * scale) << "seed " << seed;
    return !(deepest < 0.5 * random.thickness + 0.02);
  };
  std::vector<unsigned> through;
  for (unsigned seed = 1; seed <= 60; ++seed)
    if (goesThrough(seed, 0.0)) through.push_back(seed);
  if (!soft) EXPECT_TRUE(through.empty()) << testing::PrintToString(through);
  for (const unsigned seed : {91, 154, 205})
    for (const double shift : {0.0, 1e-13, 2e-13})
      if ((!soft || shift == 0.0) && goesThrough(seed, shift)) through.push_back(seed);
  EXPECT_LE(through.size(), soft ? 2u : 1u) << testing::PrintToString(through);
}

// A rod of 4 mm is levered up at 23 m/s and is through the slab before the others are brought to their next impact. At
// `reference` later solves take more work than a step may, in some starts (docs/stability.md).
TEST(EarlyMeetings, AreSeenWhereAThinBodyIsThroughByThen) {
  for (const double off : {0.0, 1e-13, -3e-13, 1e-11, 1e-9}) {
    RandomScene random(397);
    random.scene.fidelity = Fidelity::Accurate;
    for (BodyDef& def : random.scene.bodies)
      if (def.kind == BodyKind::Dynamic) def.pose.p_WB.x() += off;
    World world(random.scene);
    for (int k = 0; k < 40; ++k) {
      world.step();
      for (const BodyState& state : world.snapshot().states)
        EXPECT_LT(random.below(state.pose.p_WB), 0.5 * random.thickness + 0.02) << "step " << k;
    }
  }
}

}  // namespace

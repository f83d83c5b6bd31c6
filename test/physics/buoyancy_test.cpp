// SPDX-License-Identifier: BSD-3-Clause
// Bodies in a fluid.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

SceneDef harbour(double step) {
  SceneDef scene;
  scene.step = step;
  scene.fluid = Fluid{};
  return scene;
}

BodyDef cork(const Shape& shape, double density, const Vec3& p_W) {
  BodyDef def = body("cork", shape, p_W);
  def.density = density;
  def.material.drag_coefficient = 0.0;
  return def;
}

class Light : public testing::TestWithParam<Fidelity> {};

TEST(Buoyancy, ABodyOfTheDensityOfTheFluidStaysWhereItIs) {
  for (const Shape& shape : {Shape(Sphere{0.3}), Shape(Box{{0.2, 0.5, 0.4}}), Shape(Capsule{0.2, 0.3}),
                             Shape(Cylinder{0.2, 0.4}), Shape(Cone{0.3, 0.6})}) {
    SceneDef scene = harbour(1.0 / 60.0);
    scene.bodies.push_back(cork(shape, 1000.0, {0.0, 0.0, -5.0}));
    scene.bodies.back().pose.q_WB = rotationBy({0.4, 0.3, 0.2});
    World world(ordered(scene));
    advance(world, 10.0);
    EXPECT_LE((stateOf(world, "cork").pose.p_WB - Vec3(0.0, 0.0, -5.0)).norm(), 1e-9) << shapeName(shape);
    EXPECT_LE(stateOf(world, "cork").twist.w_WB.norm(), 1e-9) << shapeName(shape);
  }
}

// A box of draught d bobs with omega² = g/d. The map of a step turns by exactly arccos(1 - (omega h)²/2).
TEST(Buoyancy, ABoxBobsAtItsFrequencyAndKeepsItsAmplitude) {
  const double side = 1.0, density = 400.0, draught = 0.4, amplitude = 0.05;
  for (const double h : {1.0 / 60.0, 1.0 / 240.0}) {
    SceneDef scene = harbour(h);
    scene.bodies.push_back(
        cork(Box{{2.0, 2.0, side}}, density, {0.0, 0.0, 0.5 * side - draught + amplitude}));
    World world(ordered(scene));
    const double omega = std::acos(1.0 - 0.5 * kGravity / draught * h * h) / h;
    EXPECT_NEAR(omega, std::sqrt(kGravity / draught), 0.1 * h);
    for (int k = 0; k < 60.0 / h; ++k) {
      world.step();
      const double z = stateOf(world, "cork").pose.p_WB.z() - (0.5 * side - draught);
      ASSERT_NEAR(z, amplitude * std::cos(omega * world.time()), 1e-9 * amplitude) << world.time();
    }
  }
}

// A box floats upright where its metacentre is above its centre of mass: for a square section of density
// ratio s, beam b and height t that is b²/(12 s t) > (t - s t)/2 (P. Bouguer, 1746).
TEST(Buoyancy, ABoxCapsizesWhereItsMetacentreIsTooLow) {
  for (const double height : {0.7, 1.6}) {
    const double s = 0.5, beam = 1.0;
    const bool stable = beam * beam / (12.0 * s * height) > 0.5 * (1.0 - s) * height;
    SceneDef scene = harbour(1.0 / 60.0);
    scene.bodies.push_back(cork(Box{{beam, 3.0, height}}, 500.0, {0.0, 0.0, 0.0}));
    scene.bodies.back().pose.q_WB = rotationBy({0.0, 0.02, 0.0});
    World world(ordered(scene));
    double least = 1.0;
    for (int k = 0; k < 60 * 20; ++k) {
      world.step();
      least = std::min(least, (stateOf(world, "cork").pose.q_WB * Vec3::UnitZ()).z());
    }
    EXPECT_EQ(least > 0.99, stable) << height;
  }
}

TEST(Buoyancy, DragOfTheFluidBringsABodyToRestAtItsDraught) {
  SceneDef scene = harbour(1.0 / 60.0);
  scene.bodies.push_back(cork(Box{{2.0, 2.0, 1.0}}, 300.0, {0.0, 0.0, 3.0}));
  scene.bodies.back().material.drag_coefficient.reset();
  World world(ordered(scene));
  advance(world, 120.0);
  const BodyState state = stateOf(world, "cork");
  EXPECT_LE(state.twist.v_WB.norm(), 0.05);
  EXPECT_NEAR(state.pose.p_WB.z(), 0.5 - 0.3, 0.03);
}

// What is light reaches its terminal velocity within a step, and bobs faster than a step. Let go under water it rises at that
// velocity, with which it is thrown no higher than v²/(2 g) out of the water, and comes to float:
//   rho c A v²/2 = (rho V - m) g, with A the cross-section of a ball, the face of a box, a quarter of any other surface.
// In steps in which it falls faster than that, it does when it comes out of the water. Before, the load alone took it to 33 g h in
// the first step, and foam of 20 mm leapt out of the water for ever at 1/30 s, 5.6 m high.
TEST_P(Light, FoamRisesAtItsTerminalVelocityAndFloats) {
  constexpr double kCube = 0.05, kDepth = 0.3;
  for (const auto& [shape, area, top] :
       {std::tuple(Shape(Sphere{0.01}), kPi * 1e-4, 0.01), std::tuple(Shape(Sphere{0.1}), kPi * 1e-2, 0.1),
        std::tuple(Shape(Box{Vec3::Constant(kCube)}), kCube * kCube, 0.5 * kCube),
        std::tuple(Shape(Cylinder{0.01, 0.01}), 0.25 * surfaceArea(Shape(Cylinder{0.01, 0.01})), 0.01)})
    for (const double density : {30.0, 200.0})
      for (const double step : {1.0 / 10.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0}) {
        SceneDef scene = harbour(step);
        scene.fidelity = GetParam();
        scene.bodies.push_back(cork(shape, density, {0.0, 0.0, -kDepth - top}));
        const double c = 0.47 + (std::holds_alternative<Sphere>(shape) ? 0.0 : 0.58);
        scene.bodies.back().material.drag_coefficient = c;
        World world(ordered(scene));
        const double terminal =
            std::sqrt(2.0 * (1.0 - density / 1000.0) * kGravity * volume(shape) / (c * area));
        double fastest = 0.0, highest = -kDepth;
        for (int k = 0; k < 30.0 / step; ++k) {
          world.step();
          fastest = std::max(fastest, stateOf(world, "cork").twist.v_WB.norm());
          highest = std::max(highest, stateOf(world, "cork").pose.p_WB.z());
        }
        const std::string what = std::string(shapeName(shape)) + " of " + std::to_string(density) + ", 1/" +
                                 std::to_string(1.0 / step);
        EXPECT_LE(fastest, std::max(terminal, kGravity * step) * (1.0 + 1e-6)) << what;
        EXPECT_GE(fastest, 0.5 * terminal) << what;
        EXPECT_LE(highest, top + terminal * terminal / (2.0 * kGravity)) << what;
        EXPECT_LE(stateOf(world, "cork").twist.v_WB.norm(), std::max(0.2 * terminal, 0.5 * kGravity * step))
            << what;
      }
}

// With W = (omega h)² up to 1 a step follows the bobbing. What bobs faster comes to rest, and never goes beyond where it began.
TEST_P(Light, WhatBobsFasterThanAStepDiesOut) {
  const double side = 0.1;
  for (const double density : {500.0, 30.0})
    for (const double h : {1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0}) {
      SceneDef scene = harbour(h);
      scene.fidelity = GetParam();
      const double draught = density / 1000.0 * side, rest = 0.5 * side - draught, amplitude = draught;
      scene.bodies.push_back(cork(Box{{0.4, 0.4, side}}, density, {0.0, 0.0, rest - amplitude}));
      World world(ordered(scene));
      for (int k = 0; k < 200; ++k) {
        world.step();
        const double z = stateOf(world, "cork").pose.p_WB.z() - rest;
        ASSERT_LE(std::abs(z), amplitude * (1.0 + 1e-9)) << density << ", " << h << " s, step " << k;
      }
      EXPECT_NEAR(stateOf(world, "cork").pose.p_WB.z(), rest, 1e-2 * amplitude)
          << density << ", " << h << " s";
    }
}

// A foam raft bobs faster than a step of 1/60 s follows, W = 12, and under a load its bobbing is damped too: it was not where contacts
// pushed it at all, leapt at 1.5 m/s and lost its load. What they have pushed with tells only in part what they will push with,
// so that it goes on hopping (docs/stability.md).
TEST_P(Light, ALoadedRaftKeepsItsLoad) {
  for (const double h : {1.0 / 20.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0}) {
    if (GetParam() == Fidelity::Preview && h > 0.01) continue;  // falls short
    SceneDef scene = harbour(h);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("cork", {0.2, 0.2, 0.02}, {0.0, 0.0, -0.1}));  // with the drag of water
    scene.bodies.back().density = 30.0;
    scene.bodies.push_back(box("load", Vec3::Constant(0.02), {0.0, 0.0, -0.08}));
    scene.bodies.back().density = 7800.0;
    World world(ordered(scene));
    double fastest = 0.0;
    while (world.time() < 6.0) {
      world.step();
      if (world.time() > 4.0) fastest = std::max(fastest, stateOf(world, "cork").twist.v_WB.norm());
    }
    EXPECT_GT(stateOf(world, "load").pose.p_WB.z(), stateOf(world, "cork").pose.p_WB.z()) << "1/" << 1.0 / h;
    EXPECT_LE(fastest, h > 0.01 ? 0.8 : 0.1) << "1/" << 1.0 / h;
  }
}

// A pebble of 1 g on its side bears nothing worth the name, and the raft comes to lie still: with no damping where anything touches it,
// it rocks at 6 to 15 rad/s for ever.
TEST_P(Light, ARaftWithAPebbleOnItDoesNotRock) {
  for (const double h : {1.0 / 20.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0}) {
    SceneDef scene = harbour(h);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("raft", {0.2, 0.2, 0.02}, {0.0, 0.0, -0.02}));
    scene.bodies.back().density = 30.0;
    scene.bodies.push_back(box("pebble", Vec3::Constant(0.005), {0.03, 0.0, -0.0075}));
    scene.bodies.back().density = 7800.0;
    World world(ordered(scene));
    double fastest = 0.0;
    while (world.time() < 6.0) {
      world.step();
      if (world.time() > 4.0) fastest = std::max(fastest, stateOf(world, "raft").twist.w_WB.norm());
    }
    EXPECT_LE(fastest, 1.0) << "1/" << 1.0 / h;
  }
}

// What a lid holds under water presses on it with all of its buoyancy, however fast it would bob.
TEST_P(Light, WhatIsHeldUnderWaterPressesWithItsWholeBuoyancy) {
  const double side = 0.02, density = 30.0, below = 0.005;
  for (const double step : {1.0 / 10.0, 1.0 / 60.0}) {
    SceneDef scene = harbour(step);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("lid", {1.0, 1.0, 0.2}, {0.0, 0.0, 0.1 - below}));
    scene.bodies.back().kind = BodyKind::Static;
    scene.bodies.push_back(cork(Box{Vec3::Constant(side)}, density, {0.0, 0.0, -below - 0.5 * side}));
    World world(ordered(scene));
    for (int k = 0; k < 200; ++k) world.step();
    double borne = 0.0;
    for (const ContactPoint& point : world.snapshot().contacts) borne += point.normal_impulse / step;
    const double force = (1000.0 - density) * side * side * side * kGravity;
    const double most = GetParam() < Fidelity::Accurate ? 1e-3 : 1e-8;
    EXPECT_NEAR(borne, force, most * force) << step;
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, Light, testing::ValuesIn(kFidelities),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

TEST(Buoyancy, WithoutGravityAFluidHasNoWeight) {
  SceneDef scene = harbour(1.0 / 60.0);
  scene.gravity.setZero();
  scene.bodies.push_back(cork(Sphere{0.2}, 100.0, {0.0, 0.0, -1.0}));
  World world(ordered(scene));
  advance(world, 1.0);
  EXPECT_EQ(stateOf(world, "cork").pose.p_WB, Vec3(0.0, 0.0, -1.0));
}

}  // namespace

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

TEST(Buoyancy, WithoutGravityAFluidHasNoWeight) {
  SceneDef scene = harbour(1.0 / 60.0);
  scene.gravity.setZero();
  scene.bodies.push_back(cork(Sphere{0.2}, 100.0, {0.0, 0.0, -1.0}));
  World world(ordered(scene));
  advance(world, 1.0);
  EXPECT_EQ(stateOf(world, "cork").pose.p_WB, Vec3(0.0, 0.0, -1.0));
}

}  // namespace

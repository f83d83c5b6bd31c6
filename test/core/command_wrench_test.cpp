// SPDX-License-Identifier: BSD-3-Clause
// Commanded wrenches: one slot a body, whose wrench is replaced by the next and ends by itself.
#include "rigid_body_sim/world.h"

#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr double kTimeout = 0.2;  // s
const Vec3 kForce(3.0, -1.0, 2.0);

World floatingBalls() {
  SceneDef scene;
  scene.gravity = Vec3::Zero();
  scene.bodies.push_back(ball("ball", 0.5, Vec3::Zero()));
  scene.bodies.push_back(ball("other", 0.5, Vec3(9.0, 0.0, 0.0)));
  return World(scene);
}

void command(World& world, const char* name, const Vec3& force) {
  const BodyId id = world.find(name);
  world.commandWrench(id, force, Vec3::Zero(), world.pose(id).p_WB, kTimeout);
}

// What the force says, whatever the rate: until the time-out after the last command.
TEST(CommandWrench, TheMomentumIsThatOfTheForceAtAnyRate) {
  for (const double rate : {10.0, 50.0, 200.0}) {
    World world = floatingBalls();
    const double seconds = 2.0;
    int sent = 0;
    double last = 0.0;
    while (world.time() < seconds - 1e-9) {
      for (; sent / rate <= world.time() + 1e-9; ++sent) command(world, "ball", kForce), last = world.time();
      world.step();
    }
    for (int k = 0; k < 60; ++k) world.step();
    EXPECT_LT((world.totals().momentum - (last + kTimeout) * kForce).norm(), 1e-9) << rate << " Hz";
  }
}

TEST(CommandWrench, CommandsAtOneTimeDoNotPileUp) {
  World world = floatingBalls();
  for (int k = 0; k < 1000; ++k) command(world, "ball", 5.0 * kForce);
  command(world, "ball", kForce);
  command(world, "other", kForce);
  for (int k = 0; k < 60; ++k) world.step();
  EXPECT_LT((world.totals().momentum - 2.0 * kTimeout * kForce).norm(), 1e-9);
}

TEST(CommandWrench, AppliedWrenchesAddToTheCommandedOne) {
  World world = floatingBalls();
  const BodyId id = world.find("ball");
  command(world, "ball", kForce);
  world.applyWrench(id, kForce, Vec3::Zero(), Vec3::Zero(), 0.5);
  world.applyWrench(id, kForce, Vec3::Zero(), Vec3::Zero(), 0.5);
  command(world, "ball", kForce);
  for (int k = 0; k < 60; ++k) world.step();
  EXPECT_LT((world.totals().momentum - (2.0 * 0.5 + kTimeout) * kForce).norm(), 1e-9);
}

TEST(CommandWrench, AZeroCommandEndsTheOneBefore) {
  World world = floatingBalls();
  command(world, "ball", kForce);
  world.step();
  command(world, "ball", Vec3::Zero());
  for (int k = 0; k < 60; ++k) world.step();
  EXPECT_LT((world.totals().momentum - world.scene().step * kForce).norm(), 1e-12);
}

TEST(CommandWrench, GoesWithItsBodyAndWithACopy) {
  World world = floatingBalls();
  command(world, "ball", kForce);
  World copy(world);
  EXPECT_EQ(copy.stateHash(), world.stateHash());
  command(copy, "ball", 2.0 * kForce);
  EXPECT_NE(copy.stateHash(), world.stateHash());
  command(copy, "ball", kForce);
  EXPECT_EQ(copy.stateHash(), world.stateHash());
  for (int k = 0; k < 10; ++k) world.step(), copy.step();
  EXPECT_EQ(copy.stateHash(), world.stateHash());

  World with = floatingBalls(), without = floatingBalls();
  command(with, "ball", kForce);
  with.removeBody(with.find("ball"));
  without.removeBody(without.find("ball"));
  EXPECT_EQ(with.stateHash(), without.stateHash());
}

// They differ in what the next command does.
TEST(CommandWrench, IsToldFromAnAppliedOne) {
  World commanded = floatingBalls(), applied = floatingBalls();
  command(commanded, "ball", kForce);
  applied.applyWrench(applied.find("ball"), kForce, Vec3::Zero(), Vec3::Zero(), kTimeout);
  EXPECT_NE(commanded.stateHash(), applied.stateHash());
}

TEST(CommandWrench, ARefusedCommandLeavesTheOneBefore) {
  World world = floatingBalls();
  command(world, "ball", kForce);
  const std::uint64_t before = world.stateHash();
  EXPECT_THROW(command(world, "ball", Vec3(NAN, 0.0, 0.0)), InvalidInput);
  EXPECT_THROW(command(world, "ball", Vec3(1e300, 0.0, 0.0)), InvalidInput);
  EXPECT_EQ(world.stateHash(), before);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// The optional effects, one by one.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

SceneDef inAir(const Vec3& wind, double gust = 0.0) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.air = Air{};
  scene.wind = Wind{wind, gust};
  return scene;
}

// u' = -k u², k = rho C A/(2 m): u = u0/(1 + k u0 t)
TEST(Drag, SlowsASphereAsTheClosedFormSays) {
  SceneDef scene = inAir(Vec3::Zero());
  scene.bodies.push_back(ball("ball", 0.3, Vec3::Zero()));
  scene.bodies.back().mass = 0.1;
  scene.bodies.back().twist.v_WB = {0.0, 30.0, 0.0};
  World world(scene);
  const double k = 1.2 * kRoundedDrag * kPi * 0.09 / (2.0 * 0.1);
  for (int step = 0; step < 100; ++step) {
    world.step();
    EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.y(), 30.0 / (1.0 + k * 30.0 * world.time()), 1e-11);
  }
}

// The classical Runge-Kutta method in long double, at tiny steps.
TEST(Drag, ABallThrownAcrossTheWindFliesAsAnIntegrationAtTinyStepsSays) {
  SceneDef scene = inAir(Vec3(4.0, -3.0, 0.0));
  scene.gravity = kGravity * -Vec3::UnitZ();
  scene.bodies.push_back(ball("ball", 0.3, Vec3(1.0, 2.0, 3.0)));
  scene.bodies.back().mass = 0.4;
  scene.bodies.back().twist.v_WB = {-12.0, 5.0, 9.0};
  World world(scene);
  using V = Eigen::Matrix<long double, 3, 1>;
  const long double k = 1.2L * kRoundedDrag * kPi * 0.3L * 0.3L / (2.0L * 0.4L), h = 1.0L / 60.0L / 200.0L;
  const V air(4.0L, -3.0L, 0.0L), g(0.0L, 0.0L, -static_cast<long double>(kGravity));
  const auto slope = [&](const V& v) -> V { return g - k * (v - air).norm() * (v - air); };
  V p(1.0L, 2.0L, 3.0L), v(-12.0L, 5.0L, 9.0L);
  for (int step = 0; step < 120; ++step) {
    world.step();
    for (int part = 0; part < 200; ++part) {
      const V k1 = slope(v), k2 = slope(v + 0.5L * h * k1), k3 = slope(v + 0.5L * h * k2),
              k4 = slope(v + h * k3);
      p += h * (v + h / 6.0L * (k1 + k2 + k3));
      v += h / 6.0L * (k1 + 2.0L * (k2 + k3) + k4);
    }
    EXPECT_LT((stateOf(world, "ball").pose.p_WB - p.cast<double>()).norm(), 1e-11);
    EXPECT_LT((stateOf(world, "ball").twist.v_WB - v.cast<double>()).norm(), 1e-11);
  }
}

// A box that does not spin feels its projected area, in the direction of the air, and no torque.
TEST(Drag, OfABoxIsThatOfItsProjectedArea) {
  const Vec3 size(0.3, 0.5, 0.9), wind(3.0, -2.0, 1.0);
  SceneDef scene = inAir(wind);
  scene.step = 1e-5;
  scene.bodies.push_back(box("box", size, Vec3::Zero()));
  const Quat q(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()));
  scene.bodies.back().pose.q_WB = q;
  World world(scene);
  world.step();
  const Vec3 u = q.conjugate() * wind;
  const double area = std::abs(u.x()) * size.y() * size.z() + std::abs(u.y()) * size.x() * size.z() +
                      std::abs(u.z()) * size.x() * size.y();  // times |u|
  const Vec3 force = 0.5 * 1.2 * kEdgedDrag * area * wind;
  const Vec3 measured = stateOf(world, "box").twist.v_WB * (1000.0 * size.prod()) / scene.step;
  EXPECT_LE((measured - force).norm(), 1e-6 * force.norm());
  EXPECT_LE(stateOf(world, "box").twist.w_WB.norm(), 1e-12);
}

TEST(Drag, StopsASpinningPlateAndNeverTurnsItRound) {
  SceneDef scene = inAir(Vec3::Zero());
  scene.bodies.push_back(box("plate", Vec3(1.0, 1.0, 0.01), Vec3::Zero()));
  scene.bodies.back().mass = 0.01;
  scene.bodies.back().twist.w_WB = {50.0, 0.0, 0.0};
  World world(scene);
  double before = 50.0;
  for (int step = 0; step < 300; ++step) {
    world.step();
    const double spin = stateOf(world, "plate").twist.w_WB.x();
    EXPECT_LE(spin, before);
    EXPECT_GE(spin, 0.0);
    before = spin;
  }
  EXPECT_LT(before, 1.0);
}

TEST(Wind, GustsFollowTheSeedAndSpreadAsTheyWereAsked) {
  const auto record = [](std::uint64_t seed) {
    SceneDef scene = inAir(Vec3(5.0, 0.0, 0.0), 2.0);
    scene.seed = seed;
    World world(scene);
    std::vector<double> x;
    for (int step = 0; step < 60 * 400; ++step) world.step(), x.push_back(world.snapshot().air.velocity.x());
    return x;
  };
  const std::vector<double> one = record(1);
  EXPECT_EQ(one, record(1));
  EXPECT_NE(one, record(2));
  double mean = 0.0, square = 0.0;
  for (const double x : one) mean += x / one.size();
  for (const double x : one) square += (x - mean) * (x - mean) / one.size();
  EXPECT_NEAR(mean, 5.0, 0.5);
  EXPECT_NEAR(std::sqrt(square), 2.0, 0.5);
}

TEST(Wrench, ActsForItsTimeAndNoLonger) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(ball("ball", 0.5, Vec3::Zero()));
  scene.bodies.back().mass = 2.0;
  World world(scene);
  world.applyWrench(world.find("ball"), Vec3(4.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), Vec3::Zero(), 0.5);
  advance(world, 2.0);
  EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), 1.0, 1e-12);
  EXPECT_NEAR(stateOf(world, "ball").twist.w_WB.z(), 0.5 / (0.4 * 2.0 * 0.25), 1e-12);
}

TEST(Wrench, OfAnOddTimeGivesItsWholeImpulse) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(ball("ball", 0.5, Vec3::Zero()));
  scene.bodies.back().mass = 2.0;
  World world(scene);
  world.applyWrench(world.find("ball"), Vec3(4.0, 0.0, 0.0), Vec3::Zero(), Vec3::Zero(), 0.105);
  advance(world, 1.0);
  EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), 0.21, 1e-12);
}

// A body that is only too fast goes on, at the limit: in flight and beside others.
TEST(Bounds, ABodyThatIsOnlyTooFastIsSlowedDown) {
  for (const bool alone : {true, false}) {
    SceneDef scene = emptySpace(0.01);
    scene.gravity = {0.0, 0.0, -1e6};
    scene.bodies.push_back(ball("stone", 0.5, Vec3::Zero()));
    scene.bodies.back().twist.v_WB = {0.0, 0.0, -0.995 * Limits::max_speed};
    if (!alone) {
      scene.bodies.push_back(box("shelf", {1.0, 1.0, 1.0}, {1e6, 0.0, 0.0}));
      scene.bodies.back().kind = BodyKind::Static;
    }
    World world(scene);
    int told = 0;
    for (int step = 0; step < 5; ++step)
      for (const Warning& warning : world.step().warnings)
        told += warning.kind == "too_fast" && warning.text.find("'stone'") != std::string::npos;
    EXPECT_EQ(told, 5) << "alone: " << alone;
    const BodyState stone = stateOf(world, "stone");
    EXPECT_NEAR(stone.twist.v_WB.z(), -Limits::max_speed, 1e-5);
    EXPECT_NEAR(stone.pose.p_WB.z(), -0.05 * Limits::max_speed, 0.05 * 0.02 * Limits::max_speed);
    EXPECT_FALSE((*world.snapshot().bodies)[0].frozen);
    EXPECT_NO_THROW(World(world.capture(), world.captureState()));
  }
}

TEST(Bounds, ABodyThatLeavesAllBoundsIsFrozenReportedAndNeverSeen) {
  SceneDef scene = emptySpace(1.0);
  scene.bodies.push_back(ball("mote", 1e-6, Vec3(1.0, 2.0, 3.0)));
  scene.bodies.push_back(ball("stone", 0.5, Vec3::Zero()));
  scene.bodies.back().twist.v_WB = {1.0, 0.0, 0.0};
  scene.bodies[0].mass = 1e-18;
  World world(scene);
  world.applyWrench(world.find("mote"), Vec3(1e15, 0.0, 0.0), Vec3::Zero(), Vec3(1.0, 2.0, 3.0), 100.0);
  bool reported = false;
  const std::uint64_t edits = world.edits(), version = world.snapshot().description_version;
  for (int step = 0; step < 5; ++step) {
    for (const Warning& warning : world.step().warnings)
      reported = reported || (warning.kind == "non_finite" && warning.text.find("mote") != std::string::npos);
    EXPECT_EQ(stateOf(world, "mote").pose.p_WB, Vec3(1.0, 2.0, 3.0));
    EXPECT_EQ(stateOf(world, "mote").twist.v_WB.norm(), 0.0);
  }
  EXPECT_TRUE(reported);
  EXPECT_TRUE((*world.snapshot().bodies)[0].frozen);
  EXPECT_EQ(world.edits(), edits);
  EXPECT_EQ(world.snapshot().description_version, version + 1);
  EXPECT_NEAR(stateOf(world, "stone").pose.p_WB.x(), 5.0, 1e-12);

  // An edit that is not about its motion leaves it frozen; put into another place it is dynamic again.
  const BodyId mote = world.find("mote");
  BodyEdit paint;
  paint.color = Color{1.0f, 0.0f, 0.0f, 1.0f};
  world.editBody(mote, paint);
  EXPECT_TRUE((*world.snapshot().bodies)[0].frozen);
  BodyEdit move;
  move.pose = Pose{Vec3(0.0, 0.0, 9.0), Quat::Identity()};
  world.editBody(mote, move);
  EXPECT_FALSE((*world.snapshot().bodies)[0].frozen);
  EXPECT_EQ((*world.snapshot().bodies)[0].kind, BodyKind::Dynamic);
}

TEST(Hold, AHeldStaticBodyCanBeCapturedAndEdited) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(box("post", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  scene.bodies.back().kind = BodyKind::Static;
  World world(scene);
  world.hold(world.find("post"), Pose{Vec3(1.0, 0.0, 0.5), Quat::Identity()});
  world.step();
  EXPECT_GT(stateOf(world, "post").twist.v_WB.x(), 0.0);
  EXPECT_NO_THROW(World(world.capture(), world.captureState()));
  BodyEdit paint;
  paint.color = Color{1.0f, 0.0f, 0.0f, 1.0f};
  EXPECT_NO_THROW(world.editBody(world.find("post"), paint));
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction against closed forms, whatever the step. A slope is a level floor under tilted gravity.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

class Friction : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, Friction, testing::Values(1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0));

// A ball sinks into the floor by this share of its radius, about, and friction has that much less of a lever.
// It falls as the square of the step.
constexpr double kSunk = 1e-4;

// A scene on a slope with one flat box that lies on it.
SceneDef boxOnSlope(double step, double friction, double angle) {
  SceneDef scene = onFloor(step, friction);
  scene.gravity = slopeGravity(angle);
  scene.bodies.push_back(box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1)));
  scene.bodies.back().material.friction = friction;
  return scene;
}

TEST_P(Friction, ABoxStaysOnASlopeBelowTheAngleOfFriction) {
  for (const double share : {0.5, 0.9, 0.99}) {
    World world(ordered(boxOnSlope(GetParam(), 0.5, std::atan(0.5 * share))));
    advance(world, 1.0);
    const double x = stateOf(world, "box").pose.p_WB.x();
    EXPECT_LE(std::abs(x), 2e-3) << share;  // while it sinks in and finds its forces
    advance(world, 5.0);
    EXPECT_LE(std::abs(stateOf(world, "box").pose.p_WB.x() - x), 1e-9) << share;
  }
}

// v^2/(2 mu g), also where the stop is in the middle of a step, in which the speed is zero half-way.
TEST_P(Friction, ABoxStopsAfterItsWayWhereverInTheStep) {
  for (const Fidelity fidelity : {Fidelity::Interactive, Fidelity::Accurate, Fidelity::Reference})
    for (const double steps : {0.3, 0.5, 0.8, 1.5, 2.5, 10.5}) {
      constexpr double mu = 0.5, g = 10.0;
      SceneDef scene = onFloor(GetParam(), mu);
      scene.fidelity = fidelity;
      scene.gravity = {0.0, 0.0, -g};
      scene.bodies.push_back(box("box", {0.5, 0.5, 0.5}, {0.0, 0.0, 0.25}));
      scene.bodies.back().material.friction = mu;
      const double v = steps * mu * g * GetParam(), way = v * v / (2.0 * mu * g);
      scene.bodies.back().twist.v_WB.x() = v;
      World world(ordered(scene));
      for (int k = 0; k < 20; ++k) world.step();
      EXPECT_NEAR(stateOf(world, "box").pose.p_WB.x(), way, 1e-6 * way)
          << fidelityName(fidelity) << ", " << steps;
    }
}

// a = g (sin th - mu cos th)
TEST_P(Friction, ABoxSlidesDownASlopeAboveTheAngleOfFriction) {
  for (const double share : {1.01, 1.1, 2.0}) {
    const double th = std::atan(0.5 * share);
    World world(ordered(boxOnSlope(GetParam(), 0.5, th)));
    advance(world, 0.5);
    const double v = stateOf(world, "box").twist.v_WB.x();
    advance(world, 1.0);
    const double expected = kGravity * (std::sin(th) - 0.5 * std::cos(th));
    EXPECT_NEAR(stateOf(world, "box").twist.v_WB.x() - v, expected, 1e-6 * kGravity) << share;
  }
}

// v0²/(2 mu g)
TEST_P(Friction, ASlidingBoxStopsAfterItsBrakingDistance) {
  World world([&] {
    SceneDef scene = boxOnSlope(GetParam(), 0.4, 0.0);
    scene.bodies.back().twist.v_WB.x() = 5.0;
    return scene;
  }());
  advance(world, 3.0);
  const double expected = 25.0 / (2.0 * 0.4 * kGravity);
  EXPECT_NEAR(stateOf(world, "box").pose.p_WB.x(), expected, 5e-3 * expected);
  EXPECT_LE(stateOf(world, "box").twist.v_WB.norm(), 1e-9);
}

TEST_P(Friction, FrictionIsTheSameInAllDirections) {
  SceneDef scene = onFloor(GetParam(), 0.6);
  for (int k = 0; k < 16; ++k) {
    const double angle = 2.0 * kPi * k / 16;
    scene.bodies.push_back(ball("puck_" + std::to_string(k), 0.2, Vec3(100.0 * k, 0.0, 0.2)));
    BodyDef& puck = scene.bodies.back();
    puck.shape = Box{Vec3(0.4, 0.4, 0.02)};
    puck.pose.p_WB.z() = 0.01;
    puck.twist.v_WB = 5.0 * Vec3(std::cos(angle), std::sin(angle), 0.0);
  }
  World world(ordered(scene));
  advance(world, 2.0);
  double nearest = 1e300, farthest = 0.0;
  for (int k = 0; k < 16; ++k) {
    const Vec3 way = stateOf(world, "puck_" + std::to_string(k)).pose.p_WB - Vec3(100.0 * k, 0.0, 0.0);
    const double angle = 2.0 * kPi * k / 16;
    EXPECT_LE(std::abs(way.y() * std::cos(angle) - way.x() * std::sin(angle)), 5e-5 * way.norm()) << k;
    nearest = std::min(nearest, way.head<2>().norm()), farthest = std::max(farthest, way.head<2>().norm());
  }
  EXPECT_LE(farthest - nearest, 2e-4 * farthest);
}

// v = 5/7 v0 from t = 2 v0/(7 mu g) on, after 12 v0²/(49 mu g) of slipping.
TEST_P(Friction, ASlidingBallRollsInTheEndWithFiveSeventhsOfItsSpeed) {
  SceneDef scene = onFloor(GetParam(), 0.2);
  scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 0.5)));
  scene.bodies.back().material.friction = 0.2;
  scene.bodies.back().twist.v_WB.x() = 7.0;
  World world(ordered(scene));
  advance(world, 2.0);
  const BodyState rolling = stateOf(world, "ball");
  const double mu_g = 0.2 * kGravity, t_rolls = 2.0 * 7.0 / (7.0 * mu_g);
  EXPECT_NEAR(rolling.twist.v_WB.x(), 5.0, kSunk * 5.0);
  EXPECT_NEAR(rolling.twist.w_WB.y(), 10.0, kSunk * 10.0);
  EXPECT_NEAR(rolling.pose.p_WB.x(), 12.0 * 49.0 / (49.0 * mu_g) + 5.0 * (world.time() - t_rolls), 0.02);
  advance(world, 10.0);
  EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), rolling.twist.v_WB.x(), 1e-9);
}

// v = (5 v0 + 2 R w0)/7, with w0 < 0 backwards.
TEST_P(Friction, ABallWithBackspinComesBack) {
  SceneDef scene = onFloor(GetParam(), 0.3);
  scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 0.5)));
  scene.bodies.back().material.friction = 0.3;
  scene.bodies.back().twist = {Vec3(2.0, 0.0, 0.0), Vec3(0.0, -30.0, 0.0)};
  World world(ordered(scene));
  advance(world, 4.0);
  EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), (5.0 * 2.0 - 2.0 * 0.5 * 30.0) / 7.0, kSunk * 3.0);
}

// a = 5/7 g sin th while tan th <= 7/2 mu, and else g (sin th - mu cos th).
TEST_P(Friction, ABallRollsOrSlipsDownASlope) {
  for (const double share : {0.5, 0.99, 1.01, 1.5}) {
    const double mu = 0.2, th = std::atan(3.5 * mu * share);
    SceneDef scene = onFloor(GetParam(), mu);
    scene.gravity = slopeGravity(th);
    scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 0.5)));
    scene.bodies.back().material.friction = mu;
    World world(ordered(scene));
    advance(world, 0.5);
    const double v = stateOf(world, "ball").twist.v_WB.x();
    advance(world, 1.0);
    const double expected =
        share <= 1.0 ? 5.0 / 7.0 * kGravity * std::sin(th) : kGravity * (std::sin(th) - mu * std::cos(th));
    EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x() - v, expected, 5e-5 * kGravity) << share;
  }
}

// Half as wide as high: tips where tan th > width/height, if it does not slide before, at tan th > mu.
TEST_P(Friction, ABoxOnASlopeTipsOrSlides) {
  struct Case {
    double mu, tangent;
    bool tips, slides;
  };
  for (const Case& c : {Case{0.45, 0.44, false, false}, Case{0.45, 0.46, false, true},
                        Case{0.55, 0.49, false, false}, Case{0.55, 0.52, true, false}}) {
    SceneDef scene = onFloor(GetParam(), c.mu);
    scene.gravity = slopeGravity(std::atan(c.tangent));
    scene.bodies.push_back(box("box", Vec3(0.5, 0.5, 1.0), Vec3(0.0, 0.0, 0.5)));
    scene.bodies.back().material.friction = c.mu;
    World world(ordered(scene));
    advance(world, 3.0);
    const BodyState state = stateOf(world, "box");
    const bool tipped = (state.pose.q_WB * Vec3::UnitZ()).z() < 0.5;
    EXPECT_EQ(tipped, c.tips) << "mu " << c.mu << ", tan " << c.tangent;
    if (c.tips) continue;
    EXPECT_EQ(state.pose.p_WB.x() > 0.05, c.slides) << "mu " << c.mu << ", tan " << c.tangent;
  }
}

// A cylinder or capsule thrown sideways without spin slides until it rolls, straight on and at 2/3 v or so. At the soft
// settings a cylinder turned by 19 degrees and was braked by 1.4 times its weight's friction: its points turned with it.
TEST(RollingFriction, WhatRollsIsBrakedByNoMoreThanFrictionAllowsAndGoesStraight) {
  const double mu = 0.1, radius = 0.2, speed = 5.0;
  for (const Fidelity fidelity : kFidelities)
    for (const double step : {1.0 / 60.0, 1.0 / 240.0})
      for (const Shape& shape : {Shape(Cylinder{radius, 0.3}), Shape(Capsule{radius, 0.3})}) {
        SceneDef scene = onFloor(step, mu);
        scene.fidelity = fidelity;
        scene.bodies.push_back(body("log", shape, {0.0, 0.0, radius}));
        scene.bodies.back().pose.q_WB = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX());
        scene.bodies.back().twist.v_WB.x() = speed;
        scene.bodies.back().material.friction = mu;
        World world(ordered(scene));
        double most = 0.0;
        for (int k = 0; k * step < 2.0; ++k) {
          world.step();
          double normal = 0.0;
          Vec3 friction = Vec3::Zero();
          for (const ContactPoint& point : world.snapshot().contacts)
            normal += point.normal_impulse, friction += point.friction_impulse;
          most = std::max(most, friction.norm() / (mu * normal));
        }
        const BodyState log = stateOf(world, "log");
        EXPECT_LE(most, 1.01) << fidelityName(fidelity) << ", 1/" << 1.0 / step << " s";
        EXPECT_LE(std::abs((log.pose.q_WB * Vec3::UnitZ()).x()), 0.005);
        EXPECT_LE(std::abs(log.pose.p_WB.y()), 0.01);
        EXPECT_NEAR(log.twist.w_WB.y() * radius, log.twist.v_WB.x(), 0.01 * speed);
      }
}

// A prism that lies on one of its sides is thrown over the floor. Its friction cannot tip it over an edge, so that it slides
// on and is braked by mu g, and nothing turns it.
TEST(SlidingFriction, BrakesAPrismAsALawOfOnePointWouldAndDoesNotTurnIt) {
  const double friction = 0.1, speed = 5.0, radius = 0.3;
  for (const int sides : {6, 12, 24})
    for (const double angle : {0.0, 0.3, 0.8, 1.2, 0.5 * kPi})
      for (const Fidelity setting : {Fidelity::Preview, Fidelity::Interactive, Fidelity::Accurate}) {
        std::vector<Vec3> corners;
        for (const double y : {-0.5, 0.5})
          for (int k = 0; k < sides; ++k) {
            const double at = 2.0 * kPi * (k + 0.5) / sides;
            corners.emplace_back(radius * std::sin(at), y, radius * std::cos(at));
          }
        SceneDef scene = onFloor(1.0 / 60.0, friction);
        scene.fidelity = setting;
        scene.bodies.push_back(box("prism", Vec3::Ones(), Vec3(0.0, 0.0, radius * std::cos(kPi / sides))));
        BodyDef& prism = scene.bodies.back();
        prism.shape = makeHull(corners, "prism").hull;
        prism.material.friction = friction;
        prism.twist.v_WB = speed * Vec3(std::cos(angle), std::sin(angle), 0.0);
        World world(scene);
        advance(world, 0.5);
        const double before = stateOf(world, "prism").twist.v_WB.norm();
        advance(world, 1.0);
        const BodyState after = stateOf(world, "prism");
        const Vec3 along = after.pose.q_WB * Vec3::UnitY();
        const std::string which =
            std::to_string(sides) + " sides, " + std::to_string(angle) + " rad, " + fidelityName(setting);
        EXPECT_NEAR((before - after.twist.v_WB.norm()) / (friction * kGravity), 1.0, 1e-5) << which;
        EXPECT_LE(std::abs(std::atan2(along.x(), along.y())), 2e-4) << which;
      }
}

}  // namespace

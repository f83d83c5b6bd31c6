// SPDX-License-Identifier: BSD-3-Clause
// A body that a mouse holds: it comes to hang at rest, whatever it is, and at every setting and step.
#include "make_scene.h"

#include "rigid_body_sim/polyhedron.h"
#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

struct Held {
  const char* name;
  Shape shape;
  Vec3 p_B;  ///< where it is held, m
};

std::vector<Held> heldBodies() {
  const std::vector<Vec3> wedge = {{0, 0, 0}, {0.6, 0, 0}, {0, 0.4, 0}, {0, 0, 0.3}, {0.5, 0.3, 0.1}};
  const ConvexHull hull = makeHull(wedge, "wedge").hull;
  return {{"ball", Sphere{0.25}, {0.25, 0.0, 0.0}},
          {"box by a corner", Box{{0.5, 0.5, 0.5}}, {0.25, 0.25, 0.25}},
          {"box by the middle of a side", Box{{0.5, 0.5, 0.5}}, {0.25, 0.0, 0.0}},
          {"plank by a corner", Box{{0.6, 0.3, 0.05}}, {0.3, 0.15, 0.025}},
          {"needle by an end", Box{{0.5, 0.01, 0.01}}, {0.25, 0.0, 0.0}},
          {"needle by its middle", Box{{0.5, 0.01, 0.01}}, {0.0, 0.002, 0.0}},
          {"hull by a corner", hull, hull.polyhedron->vertices.front()},
          {"crumb by a corner", Box{{0.01, 0.01, 0.01}}, {0.005, 0.005, 0.005}}};
}

/// A body without others, that turns and is held still by a point from now on.
World held(const Held& what, double step, Fidelity fidelity, double gravity = kGravity,
           const Quat& q_WB = Quat::Identity(), const Vec3& w_WB = {3.0, 2.0, 4.0},
           double frequency = Grab{}.frequency) {
  SceneDef scene = emptySpace(step);
  scene.gravity = {0.0, 0.0, -gravity};
  scene.fidelity = fidelity;
  scene.bodies.push_back(body("body", what.shape, Vec3::Zero()));
  scene.bodies.back().pose.q_WB = q_WB;
  scene.bodies.back().twist.w_WB = w_WB;
  World world(scene);
  Grab grab;
  grab.p_B = what.p_B;
  grab.p_W = q_WB * what.p_B;
  grab.frequency = frequency;
  world.grab(world.find("body"), grab);
  return world;
}

/// The orientation in which the point p_B stands `angle` beside the upright over the centre of mass, towards
/// `heading`.
Quat orientation(const Vec3& p_B, double angle, double heading) {
  const Vec3 axis(-std::sin(heading), std::cos(heading), 0.0);
  return Quat(Eigen::AngleAxisd(angle, axis)) * Quat::FromTwoVectors(p_B, Vec3::UnitZ());
}

/// The angle between the held point, seen from the centre of mass, and the upright.
double angleFromHanging(const BodyState& state, const Vec3& p_B) {
  const Vec3 r_W = state.pose.q_WB * p_B;
  return std::atan2(std::hypot(r_W.x(), r_W.y()), r_W.z());
}

class UserForce : public ::testing::TestWithParam<Fidelity> {};

TEST_P(UserForce, AHeldBodyHangsStillWithinASecond) {
  for (const double step : {1.0 / 30.0, 1.0 / 60.0, 1.0 / 480.0}) {
    for (const Held& what : heldBodies()) {
      for (const double angle : {0.1, 0.5, 1.0, 1.6, 2.0}) {
        World world = held(what, step, GetParam(), kGravity, orientation(what.p_B, angle, 5.0 * angle));
        advance(world, 1.0);
        const BodyState state = stateOf(world, "body");
        const auto where =
            std::string(what.name) + " from " + std::to_string(angle) + ", step " + std::to_string(step);
        // Nearly balanced, it tips in seconds: the weight has no lever.
        if (what.p_B.norm() < 0.01 * boundingRadius(what.shape)) continue;
        EXPECT_LE(state.twist.w_WB.norm(), 0.15) << where;
        EXPECT_LE(state.twist.v_WB.norm(), 0.15) << where;
        EXPECT_LE(angleFromHanging(state, what.p_B), 0.05) << where;
      }
    }
  }
}

// Its fall and its stop follow the law, integrated here for a pendulum without a spring by the classical rule
// of Runge and Kutta: theta'' = -W² sin theta + (40/s + 2 W) max(0, -theta' - 8/s theta), W² = m g l / I_P,
// theta > 0.
TEST(UserForceLaw, ABodyFallsFreelyAndThenStops) {
  const double side = 0.5, lever = 0.25;
  const double swing2 = kGravity * lever / (side * side / 6.0 + lever * lever);
  const auto rate = [&](double theta, double speed) {
    return -swing2 * std::sin(theta) + (40.0 + 2.0 * std::sqrt(swing2)) * std::max(0.0, -speed - 8.0 * theta);
  };
  const Held what{"box", Box{{side, side, side}}, {lever, 0.0, 0.0}};
  World world = held(what, 1.0 / 10000.0, Fidelity::Interactive, kGravity, orientation(what.p_B, 1.5, 0.0),
                     Vec3::Zero(), 1000.0);
  double theta = 1.5, speed = 0.0;
  const double h = 1e-4;
  for (int k = 1; k <= 8; ++k) {
    for (int n = 0; n < 1000; ++n) {
      const double k1 = rate(theta, speed), s2 = speed + 0.5 * h * k1;
      const double k2 = rate(theta + 0.5 * h * speed, s2), s3 = speed + 0.5 * h * k2;
      const double k3 = rate(theta + 0.5 * h * s2, s3), s4 = speed + h * k3;
      const double k4 = rate(theta + h * s3, s4);
      theta += h * (speed + 2.0 * s2 + 2.0 * s3 + s4) / 6.0;
      speed += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    advance(world, 0.1);
    const BodyState state = stateOf(world, "body");
    EXPECT_NEAR(angleFromHanging(state, what.p_B), theta, 5e-3) << 0.1 * k << " s";
    EXPECT_NEAR(state.twist.w_WB.norm(), -speed, 0.03) << 0.1 * k << " s";
  }
}

// What nearly balances tips by its weight, which has no lever: it falls in its own time and then hangs, too.
TEST_P(UserForce, AHeldBodyComesToHangFromWhereverItIs) {
  for (const Held& what : heldBodies()) {
    World world = held(what, 1.0 / 60.0, GetParam());
    advance(world, 12.0);
    const BodyState state = stateOf(world, "body");
    EXPECT_LE(state.twist.w_WB.norm(), 2e-3) << what.name;
    EXPECT_LE(state.twist.v_WB.norm(), 2e-3) << what.name;
    EXPECT_LE(angleFromHanging(state, what.p_B), 0.01) << what.name;
  }
}

// A body of ten metres swings slowly, and comes to hang as slowly; it never swings up again.
TEST_P(UserForce, AHugeBodyHangsAtRestInItsOwnTime) {
  World world = held({"block", Box{{10.0, 8.0, 6.0}}, {5.0, 4.0, 3.0}}, 1.0 / 60.0, GetParam());
  advance(world, 10.0);
  EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 0.02);
}

TEST_P(UserForce, WithoutGravityItStopsTurning) {
  for (const Held& what : heldBodies()) {
    World world = held(what, 1.0 / 60.0, GetParam(), 0.0);
    advance(world, 2.0);
    EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 1e-2) << what.name;
  }
}

// What damps cannot drive: the energy of turning never grows where nothing else acts, however fast it turns.
TEST_P(UserForce, ItNeverSpinsABodyUp) {
  for (const double speed : {1.0, 1e3}) {
    for (const Held& what : heldBodies()) {
      World world = held(what, 1.0 / 60.0, GetParam(), 0.0);
      BodyEdit edit;
      edit.twist = Twist{Vec3::Zero(), speed * Vec3(0.1, 1.0, 0.3)};
      world.editBody(world.find("body"), edit);
      double before = world.totals().kinetic_energy;
      const double first = before;
      for (int k = 0; k < 120; ++k) {
        world.step();
        const double now = world.totals().kinetic_energy;
        EXPECT_LE(now, before + 0.02 * first) << what.name << ", step " << k;
        before = now;
      }
      EXPECT_LE(before, 1e-3 * first) << what.name;
    }
  }
}

// A mouse far behind a wall presses with the greatest force that it has, and no more.
TEST_P(UserForce, ItPressesNoHarderThanItMay) {
  for (const double behind : {1.0, 10.0, 1000.0}) {
    SceneDef scene = emptySpace(1.0 / 60.0);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("wall", {1.0, 4.0, 4.0}, {0.75, 0.0, 0.0}));
    scene.bodies.back().kind = BodyKind::Static;
    scene.bodies.push_back(ball("ball", 0.25, Vec3::Zero()));
    scene.bodies.back().mass = 3.0;
    World world(ordered(scene));
    Grab grab;
    grab.p_W = {behind, 0.0, 0.0};
    world.grab(world.find("ball"), grab);
    advance(world, 1.0);
    double pressed = 0.0;
    for (const ContactPoint& point : world.snapshot().contacts) pressed += point.normal_impulse;
    const double most = 3.0 * grab.max_acceleration * scene.step;
    EXPECT_LE(pressed, 1.001 * most) << behind << " m behind";
    if (behind >= 10.0) EXPECT_GE(pressed, 0.999 * most) << behind << " m behind";
  }
}

// What is left of the way and of the angle decays as exp(-t/tau), by the shorter way round.
TEST_P(UserForce, AHoldClosesOnItsTargetTheShortWay) {
  constexpr double kTau = 1.0 / 30.0, kTime = 0.1;
  const Vec3 axis = Vec3(1.0, -2.0, 0.5).normalized();
  for (const double angle : {-6.0, -3.0, -1.0, 0.5, 3.0, 3.3, 5.0}) {
    SceneDef scene = emptySpace(1.0 / 60.0);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("crate", {0.4, 0.6, 0.8}, Vec3::Zero()));
    World world(scene);
    world.hold(world.find("crate"), {Vec3(1.0, 2.0, -3.0), Quat(Eigen::AngleAxisd(angle, axis))});
    advance(world, kTime);
    const BodyState state = stateOf(world, "crate");
    const double share = 1.0 - std::exp(-kTime / kTau), shorter = std::remainder(angle, 2.0 * kPi);
    EXPECT_LE((state.pose.p_WB - share * Vec3(1.0, 2.0, -3.0)).norm(), 1e-12) << angle;
    EXPECT_LE(state.pose.q_WB.angularDistance(Quat(Eigen::AngleAxisd(share * shorter, axis))), 1e-7) << angle;
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, UserForce, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return fidelityName(info.param); });

}  // namespace

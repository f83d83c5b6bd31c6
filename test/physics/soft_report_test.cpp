// SPDX-License-Identifier: BSD-3-Clause
// What the soft step reports of itself, against what can be reckoned from the motion alone: impulses,
// residuals, the depth of its contacts, and that parting adds no speed.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0;

class SoftReport : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, SoftReport, testing::Values(Fidelity::Preview, Fidelity::Interactive),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

// A column of balls, which cannot turn: normal velocities are differences of vertical ones.
SceneDef column(int balls) {
  SceneDef scene = onFloor(kStep, 0.0);
  for (int k = 0; k < balls; ++k) {
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.5, Vec3(0.0, 0.0, 0.5 + k)));
    scene.bodies.back().material.friction = 0.0;
  }
  return scene;
}

// A load F sinks a mass m in by F/(m w^2), w being a fixed share of the rate of sub-steps: by a quarter where they are twice
// as many. That there are as many as the setting asks for is seen there.
TEST_P(SoftReport, AsManySubStepsAreTakenAsTheSettingAsksFor) {
  double depth = 0.0;
  for (const unsigned n : {8, 16, 64, 128, 256, 512, 1000}) {
    SceneDef scene = column(1);
    scene.fidelity = GetParam(), scene.fidelity.sub_steps = n;
    World world(scene);
    advance(world, 1.0);
    const double scaled = world.step().deepest_penetration * n * n;
    if (depth > 0.0) EXPECT_NEAR(scaled, depth, 0.02 * depth) << n;
    depth = scaled;
  }
}

// The change of momentum in a step is what its loads and its contacts give.
TEST_P(SoftReport, ImpulsesBalanceTheMomentum) {
  SceneDef scene = onFloor(kStep, 0.5);
  BodyDef crate = box("crate", Vec3(0.4, 0.6, 1.0), Vec3(0.0, 0.0, 0.8));
  crate.pose.q_WB = Quat(Eigen::AngleAxisd(0.5, Vec3(1.0, 2.0, 0.5).normalized()));
  crate.twist.v_WB.x() = 1.5;
  crate.mass = 10.0;
  scene.bodies.push_back(crate);
  scene.fidelity = GetParam();
  World world(ordered(scene));
  int steps_in_contact = 0;
  Vec3 before = stateOf(world, "crate").twist.v_WB;
  for (int k = 0; k < 180; ++k) {
    world.step();
    const Vec3 after = stateOf(world, "crate").twist.v_WB;
    Vec3 impulse = Vec3::Zero();
    for (const ContactPoint& point : world.snapshot().contacts)
      impulse += (point.b == world.find("crate") ? 1.0 : -1.0) *
                 (point.normal_impulse * point.n_W + point.friction_impulse);
    const Vec3 expected = 10.0 * (after - before + Vec3(0.0, 0.0, kGravity * kStep));
    ASSERT_LE((impulse - expected).norm(), 1e-9) << "step " << k;
    steps_in_contact += impulse.norm() > 0.0;
    before = after;
  }
  EXPECT_GT(steps_in_contact, 100);
}

// Where nothing rubs, all that a plane gives is normal, also of a point that is found anew several times in a step.
TEST_P(SoftReport, WithoutFrictionAPlaneGivesNormalImpulsesAlone) {
  int points = 0;
  for (const double spin : {1.0, 5.0, 10.0, 20.0, 40.0})
    for (const Vec3& axis : {Vec3(1.0, 0.0, 0.0), Vec3(1.0, 2.0, 0.5)}) {
      SceneDef scene = onFloor(kStep, 0.0);
      scene.fidelity = GetParam();
      BodyDef crate = box("crate", Vec3(0.4, 0.6, 1.0), Vec3(0.0, 0.0, 0.6));
      crate.twist.w_WB = spin * axis.normalized();
      crate.material.friction = 0.0, crate.mass = 10.0;
      scene.bodies.push_back(crate);
      World world(ordered(scene));
      world.applyWrench(world.find("crate"), Vec3(0.0, 0.0, -2000.0), Vec3::Zero(), crate.pose.p_WB, 10.0);
      for (int k = 0; k < 120; ++k) {
        world.step();
        for (const ContactPoint& point : world.snapshot().contacts) {
          points += point.normal_impulse > 0.0;
          EXPECT_LE(point.friction_impulse.norm(), 1e-12 * point.normal_impulse) << spin << ", step " << k;
        }
      }
    }
  EXPECT_GT(points, 100);
}

// Where a step has more impacts than it may take one by one, contacts stop the rest, and they rebound at its end.
TEST_P(SoftReport, WhatContactsStopReboundsAsFastAsAnImpactWould) {
  constexpr double kSpeed = 10.0, kRestitution = 0.5;
  SceneDef scene = onFloor(kStep, 0.5);
  scene.fidelity = GetParam();
  scene.bodies.push_back(box("table", Vec3(4.0, 4.0, 0.5), Vec3(0.0, 0.0, 1.25)));
  scene.bodies.back().mass = 1000.0;
  for (int k = 0; k < 16; ++k) {
    const Vec3 place(1.2 * (k % 4) - 1.8, 1.2 * (k / 4) - 1.8, 0.5);
    scene.bodies.push_back(box("leg_" + std::to_string(k), Vec3(0.4, 0.4, 1.0), place));
    scene.bodies.back().mass = 1000.0;
  }
  World world(ordered(scene));
  advance(world, 0.5);
  constexpr int kBalls = 100;
  for (int k = 0; k < kBalls; ++k) {
    const double before = (0.2 + 0.006 * k) * kStep;  // the time to its impact
    const Vec3 place(0.36 * (k % 10) - 1.62, 0.36 * (k / 10) - 1.62, 1.6 + kSpeed * before);
    BodyDef falling = ball("ball_" + std::to_string(k), 0.1, place);
    falling.mass = 0.01, falling.material.restitution = kRestitution;
    falling.twist.v_WB.z() = -kSpeed;
    world.addBody(falling);
  }
  EXPECT_GT(world.step().deferred_impacts, 20u);
  for (int k = 0; k < kBalls; ++k)
    EXPECT_NEAR(stateOf(world, "ball_" + std::to_string(k)).twist.v_WB.z(), kRestitution * kSpeed, 0.5) << k;
}

// signorini is the largest |u_n| of a loaded point over g h, whatever is unresolved.
TEST(SoftResiduals, OfAColumnAreItsClosingSpeeds) {
  SceneDef scene = column(8);
  scene.fidelity = Fidelity::Preview;
  scene.fidelity.sub_steps = 1;  // a point is loaded when its impulse is not zero
  scene.bodies.back().mass = 4000.0;
  World world(ordered(scene));
  double largest = 0.0;
  for (int k = 0; k < 60; ++k) {
    const StepReport& report = world.step();
    if (report.impacts > 0 || report.residuals.size() != 1) continue;
    ASSERT_STREQ(report.residuals[0].method, "soft_step");
    const Snapshot now = world.snapshot();
    const auto speedOf = [&](BodyId id) {
      return now.states[static_cast<std::size_t>(now.find(id))].twist.v_WB;
    };
    double expected = 0.0;
    for (const ContactPoint& point : now.contacts) {
      const double u_n = point.n_W.dot(speedOf(point.b) - speedOf(point.a));
      if (point.normal_impulse > 0.0)
        expected = std::max(expected, std::abs(u_n));
      else if (point.separation <= 0.0)
        expected = std::max(expected, -u_n);
    }
    EXPECT_NEAR(report.residuals[0].signorini, expected / (kGravity * kStep), 1e-9) << "step " << k;
    largest = std::max(largest, expected);
  }
  EXPECT_GT(largest, 1e-3);  // there was something to tell
}

// So it is the largest closing speed of an unloaded point that is closed. In triangles of balls of all masses a sweep
// leaves some: a point that parted is pushed together by those after it.
TEST(SoftResiduals, OfTrianglesCountThePointsThatAreUnloaded) {
  std::mt19937 random(5);
  std::uniform_real_distribution<> within(-1.0, 1.0);
  int steps = 0;  // in which such a point is the worst
  for (int scenes = 0; scenes < 1000; ++scenes) {
    SceneDef scene = onFloor(kStep, 0.0);
    scene.fidelity = Fidelity::Preview;
    scene.fidelity.sub_steps = 1;  // a point is loaded when its impulse is not zero
    const int rows = 2 + scenes % 4;
    for (int row = 0; row < rows; ++row)
      for (int k = 0; k < rows - row; ++k) {
        const Vec3 place(k + 0.5 * row, 0.0, 0.5 + std::sqrt(0.75) * row);
        scene.bodies.push_back(ball("", 0.5, place + 1e-3 * Vec3(within(random), 0.0, within(random))));
        scene.bodies.back().mass = std::pow(10.0, 2.0 * within(random));
        scene.bodies.back().material.friction = 0.0;
        scene.bodies.back().twist.v_WB = 0.1 * Vec3(within(random), 0.0, within(random));
      }
    World world(scene);
    for (int k = 0; k < 20; ++k) {
      const StepReport& report = world.step();
      if (report.impacts > 0 || report.residuals.size() != 1) continue;
      const Snapshot now = world.snapshot();
      double loaded = 0.0, unloaded = 0.0;
      bool deep = false;  // kept from gaining energy after the solve
      for (const ContactPoint& point : now.contacts) {
        const auto velocityOf = [&](BodyId id) { return now.states[now.find(id)].twist.v_WB; };
        const double u_n = point.n_W.dot(velocityOf(point.b) - velocityOf(point.a));
        deep = deep || point.separation < -0.02;
        if (point.normal_impulse > 0.0)
          loaded = std::max(loaded, std::abs(u_n));
        else if (point.separation <= 0.0)
          unloaded = std::max(unloaded, -u_n);
      }
      if (deep || unloaded < std::max(loaded, 1e-3)) continue;
      ++steps;
      EXPECT_NEAR(report.residuals[0].signorini * kGravity * kStep, unloaded, 1e-6 * unloaded)
          << "scene " << scenes << ", step " << k;
    }
  }
  EXPECT_GT(steps, 5);
}

// dissipation is the largest slip that friction does not oppose: of a point that sticks, all of its slip.
TEST(SoftResiduals, OfFrictionAreTheSlipThatItLeaves) {
  SceneDef scene = onFloor(kStep, 0.5);
  for (int k = 0; k < 6; ++k) {
    scene.bodies.push_back(
        box("box_" + std::to_string(k), Vec3(1.0, 1.0, 0.2), Vec3(0.02 * k, 0.0, 0.1 + 0.2 * k)));
    scene.bodies.back().material.friction = 0.5;
  }
  scene.fidelity = Fidelity::Preview;
  scene.fidelity.sub_steps = 1;
  World world(ordered(scene));
  advance(world, 0.5);
  world.applyImpulse(world.find("box_5"), Vec3(100.0, 30.0, 0.0), stateOf(world, "box_5").pose.p_WB);
  double largest = 0.0, told = 0.0;
  for (int k = 0; k < 12; ++k) {
    const StepReport& report = world.step();
    if (report.impacts > 0 || report.residuals.size() != 1) continue;
    const Snapshot now = world.snapshot();
    const auto velocityAt = [&](BodyId id, const Vec3& p_W) -> Vec3 {
      const BodyState& state = now.states[static_cast<std::size_t>(now.find(id))];
      return state.twist.v_WB + state.twist.w_WB.cross(p_W - state.pose.p_WB);
    };
    double expected = 0.0;
    for (const ContactPoint& point : now.contacts) {
      if (!(point.normal_impulse > 0.0)) continue;
      Vec3 u = velocityAt(point.b, point.p_W) - velocityAt(point.a, point.p_W);
      u -= point.n_W.dot(u) * point.n_W;
      const double friction = point.friction_impulse.norm();
      if (friction >= 0.5 * point.normal_impulse * (1.0 - 1e-9))
        u += u.norm() / friction * point.friction_impulse;
      expected = std::max(expected, u.norm());
    }
    largest = std::max(largest, expected);
    told = std::max(told, report.residuals[0].dissipation * kGravity * kStep);
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_NEAR(told / largest, 1.0, 0.3);  // its arms are those of the start of the step
}

// The relaxing pass takes away the speed that only served to part the bodies.
TEST_P(SoftReport, PartingAddsNoSpeed) {
  for (const bool boxes : {false, true}) {
    SceneDef scene = emptySpace(kStep);
    for (const double x : {-0.49, 0.49}) {
      const std::string name = x < 0.0 ? "left" : "right";
      scene.bodies.push_back(boxes ? box(name, Vec3::Ones(), Vec3(x, 0.0, 0.0))
                                   : ball(name, 0.5, Vec3(x, 0.0, 0.0)));
    }
    scene.fidelity = GetParam();
    for (const SceneDef& one : inBothOrders(scene)) {
      World world(one);
      double fastest = 0.0;
      for (int k = 0; k < 120; ++k) {
        world.step();
        fastest = std::max(fastest, stateOf(world, "right").twist.v_WB.norm());
      }
      EXPECT_LE(fastest, boxes ? 0.05 : 1e-9);  // the spring alone would leave them with 0.2 m/s each
      EXPECT_GT(stateOf(world, "right").pose.p_WB.x() - stateOf(world, "left").pose.p_WB.x(), 0.998) << boxes;
    }
  }
}

// At rest a contact sags by g/w², w = 0.3 pi/h, with h the length of a sub-step: one more or fewer shows.
TEST(SubSteps, AreAsManyAsTheSettingSays) {
  for (const std::uint32_t sub_steps : {1u, 4u, 8u}) {
    SceneDef scene = column(1);
    scene.fidelity = Fidelity::Preview;
    scene.fidelity.sub_steps = sub_steps;
    World world(ordered(scene));
    advance(world, 4.0);
    const double w = 0.3 * kPi / (kStep / sub_steps);
    const double sag = 0.5 - stateOf(world, "ball_0").pose.p_WB.z();
    EXPECT_NEAR(sag * w * w / kGravity, 1.0, 0.02) << sub_steps;
  }
}

}  // namespace
}  // namespace rbs::test

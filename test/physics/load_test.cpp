// SPDX-License-Identifier: BSD-3-Clause
// Loads far beyond gravity, at every setting.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

namespace rbs::test {
namespace {

class Load : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, Load, testing::ValuesIn(kFidelities),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

TEST_P(Load, ABoxThatIsPressedOnTheFloorStaysOnIt) {
  for (const double a : {10.0, 100.0, 1e3, 1e4, 1e5, 1e6}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("box", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
    scene.bodies.back().mass = 1.0;
    World world(ordered(scene));
    world.applyWrench(world.find("box"), Vec3(0.0, 0.0, -a), Vec3::Zero(), Vec3(0.0, 0.0, 0.5), 1.0);
    double sunk = 0.0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      sunk = std::max(sunk, 0.5 - stateOf(world, "box").pose.p_WB.z());
    }
    EXPECT_LT(sunk, 0.12) << a << " m/s²";
  }
}

TEST_P(Load, ABodyThatIsMadeLightUnderALoadIsNotShotAway) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.fidelity = GetParam();
  scene.bodies.push_back(box("under", Vec3(1.0, 1.0, 0.4), Vec3(0.0, 0.0, 0.2)));
  scene.bodies.push_back(box("over", Vec3(1.0, 1.0, 1.0), Vec3(0.6, 0.0, 0.9)));
  scene.bodies[1].mass = 100.0;
  scene.bodies[2].mass = 5000.0;
  World world(ordered(scene));
  advance(world, 0.3);  // the upper box tips, and the lower one rises at its other end
  BodyEdit edit;
  edit.mass = 0.1;
  world.editBody(world.find("under"), edit);
  double fastest = 0.0;
  for (int k = 0; k < 30; ++k) {
    world.step();
    fastest = std::max(fastest, stateOf(world, "under").twist.v_WB.norm());
  }
  EXPECT_LT(fastest, 10.0);
}

// On a smooth floor a torque about the vertical turns a crate by the moment of inertia about it alone.
TEST_P(Load, ATorqueTurnsWhatStandsByItsOwnMomentOfInertia) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.0);
  scene.fidelity = GetParam();
  scene.bodies.push_back(box("crate", Vec3(0.8, 1.2, 0.4), Vec3(0.0, 0.0, 0.2)));
  scene.bodies.back().mass = 30.0, scene.bodies.back().material.friction = 0.0;
  World world(ordered(scene));
  world.applyWrench(world.find("crate"), Vec3::Zero(), Vec3(0.0, 0.0, 2.0), Vec3::Zero(), 10.0);
  advance(world, 1.0);
  const double moment = 30.0 * (0.8 * 0.8 + 1.2 * 1.2) / 12.0;
  EXPECT_NEAR(stateOf(world, "crate").twist.w_WB.z(), 2.0 / moment, 1e-6);
}

// The force is done on the point that it was applied to, wherever the rod turns it: its work is the force
// times the way of that point.
// A rod at rest is turned so fast that its end would be past a thin plate in the first step. It levers itself off the plate.
TEST_P(Load, ATorqueTurnsNothingThroughAPlate) {
  for (const double torque : {1.0, 10.0, 33.0})
    for (const double gap : {0.02, 0.06}) {
      SceneDef scene = emptySpace(1.0 / 60.0);
      scene.fidelity = GetParam();
      scene.bodies.push_back(box("plate", {0.4, 1.0, 0.005}, {0.4, 0.0, 0.01 + gap + 0.0025}));
      scene.bodies.back().kind = BodyKind::Static;
      scene.bodies.push_back(box("rod", {1.0, 0.02, 0.02}, Vec3::Zero()));
      scene.bodies.back().mass = 0.4;
      World world(ordered(scene));
      world.applyWrench(world.find("rod"), Vec3::Zero(), Vec3(0.0, -torque, 0.0), Vec3::Zero(), 1.0);
      for (int k = 0; k < 5; ++k) {
        world.step();
        // Whether the end that comes up to the plate, or the edge of the plate, is through.
        const Pose X_WR = stateOf(world, "rod").pose;
        const Vec3 edge_R = X_WR.q_WB.conjugate() * (Vec3(0.2, 0.0, 0.01 + gap) - X_WR.p_WB);
        const bool beside = std::abs(edge_R.x()) < 0.5;
        if (beside) EXPECT_GT(edge_R.z(), -0.004) << torque << " N m, " << gap << " m, step " << k;
      }
    }
}

// A cube that nothing touches turns by alpha t^2/2, whether another one is near or not.
TEST_P(Load, ATorqueTurnsWhatHasNeighboursLikeWhatHasNone) {
  for (const bool near : {false, true}) {
    SceneDef scene = emptySpace(1.0 / 30.0);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("cube", Vec3::Ones(), Vec3::Zero()));
    scene.bodies.push_back(box("other", Vec3::Ones(), {near ? 1.25 : 5.0, 0.0, 0.0}));
    scene.bodies[0].mass = 6.0;  // I = 1 kg m^2
    World world(ordered(scene));
    world.applyWrench(world.find("cube"), Vec3::Zero(), Vec3(0.0, 0.0, 2.0), Vec3::Zero(), 5.0);
    for (int k = 0; k < 11; ++k) world.step();
    const Quat turned(Eigen::AngleAxisd(world.time() * world.time(), Vec3::UnitZ()));
    EXPECT_LE(stateOf(world, "cube").pose.q_WB.angularDistance(turned), 1e-9) << near;
  }
}

TEST_P(Load, TheForceOfAWrenchMovesWithItsPoint) {
  SceneDef scene = emptySpace(1.0 / 960.0);
  scene.fidelity = GetParam();
  scene.bodies = {box("rod", Vec3(2.0, 0.1, 0.1), Vec3::Zero())};
  scene.bodies[0].mass = 1.0;
  World world(scene);
  const Vec3 end_B(1.0, 0.0, 0.0), force(0.0, 3.0, 0.5);
  world.applyWrench(world.find("rod"), force, Vec3::Zero(), end_B, 10.0);
  double turned = 0.0;
  for (int k = 0; k < 4; ++k) {
    advance(world, 0.5);
    const BodyState state = stateOf(world, "rod");
    const Vec3 way = state.pose.p_WB + state.pose.q_WB * end_B - end_B;
    EXPECT_NEAR(world.totals().kinetic_energy, force.dot(way), 1e-5 * force.dot(way))
        << 0.5 * (k + 1) << " s";
    turned = std::max(turned, state.pose.q_WB.angularDistance(Quat::Identity()));
  }
  EXPECT_GT(turned, 1.0);
}

// A ball deep between two walls that lean apart by 2 degrees: to part from both at v it would leave at 57 v.
// What it gains in a step is the speed at which an overlap may part, that of a fall of its size, and what it
// falls.
TEST_P(Load, WhatIsWedgedInDoesNotShootOut) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.gravity = Vec3(0.0, 0.0, -kGravity);
  scene.fidelity = GetParam();
  const double radius = 0.1, depth = 0.06;
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(box(side < 0.0 ? "left" : "right", Vec3(1.0, 1.0, 2.0),
                               Vec3(side * (0.5 + radius - depth), 0.0, 0.0)));
    scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(side * kPi / 180.0, Vec3::UnitY()));
    scene.bodies.back().kind = BodyKind::Static;
  }
  scene.bodies.push_back(ball("ball", radius, Vec3::Zero()));
  for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
  World world(ordered(scene));
  const double most = std::sqrt(kGravity * 2.0 * radius) + kGravity * scene.step;
  double before = 0.0;
  for (int k = 0; k < 120; ++k) {
    world.step();
    const double speed = stateOf(world, "ball").twist.v_WB.norm();
    ASSERT_LE(speed, before + most * (1.0 + 1e-9)) << "step " << k;
    before = speed;
  }
}

// Nothing closes, and nothing carries them: still they are in each other.
TEST_P(Load, BallsInEachOtherPartThoughTheyFlyAlike) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.fidelity = GetParam();
  for (const double x : {0.0, 0.3}) {
    scene.bodies.push_back(ball(x == 0.0 ? "one" : "two", 0.5, Vec3(x, 0.0, 0.0)));
    scene.bodies.back().twist.v_WB = Vec3(0.0, 1.0, 2.0);
  }
  World world(ordered(scene));
  advance(world, 2.0);
  EXPECT_GT((stateOf(world, "two").pose.p_WB - stateOf(world, "one").pose.p_WB).norm(), 0.99);
}

// Friction holds each of these against a wind that pushes with a part of its weight: the forces of its
// contacts are those of the air and of gravity, whole, also where the drag of its own motion would be stiff.
TEST_P(Load, ABodyThatStandsInTheWindFeelsTheWholeDrag) {
  const double density = 1.2, speed = 10.0;
  for (const double step : {1.0 / 60.0, 0.1}) {
    // What sinks in leans with the wind, which then meets another area.
    if (GetParam() < Fidelity::Accurate && step > 0.05) continue;
    for (const double heavy : {100.0, 20.0}) {
      if (GetParam() == Fidelity::Preview && heavy < 50.0) continue;  // a light cylinder rattles there
      SceneDef scene = onFloor(step, 2.0);
      scene.fidelity = GetParam();
      scene.air = Air{density};
      scene.wind = Wind{{speed, 0.0, 0.0}, 0.0};
      scene.bodies.push_back(box("box", Vec3::Constant(0.5), {0.0, 0.0, 0.25}));
      scene.bodies.push_back(body("cylinder", Cylinder{0.3, 0.2}, {0.0, 3.0, 0.2}));
      for (const int k : {1, 2}) scene.bodies[k].density = heavy, scene.bodies[k].material.friction = 2.0;
      World world(ordered(scene));
      for (int k = 0; k < 200; ++k) world.step();
      const Snapshot now = world.snapshot();
      for (const auto& [name, area, mass] :
           {std::tuple("box", 0.25, 0.125 * heavy),
            std::tuple("cylinder", 0.25 * surfaceArea(Shape(Cylinder{0.3, 0.2})), kPi * 0.036 * heavy)}) {
        const Vec3 loads(0.5 * density * kEdgedDrag * area * speed * speed, 0.0, -mass * kGravity);
        Vec3 borne = Vec3::Zero();
        const BodyId id = world.find(name);
        for (const ContactPoint& point : now.contacts)
          if (point.a == id || point.b == id)
            borne += (point.b == id ? 1.0 : -1.0) / step *
                     (point.normal_impulse * point.n_W + point.friction_impulse);
        const double most = GetParam() == Fidelity::Preview       ? 1e-2
                            : GetParam() == Fidelity::Interactive ? 1e-3
                                                                  : 1e-9;
        EXPECT_LE((borne + loads).norm(), most * loads.norm())
            << name << " of " << heavy << " kg/m³, step " << step << ": " << borne.transpose();
      }
    }
  }
}

// Friction may jam a rigid body with forces of any size that balance each other, and the exact step leaves those that it found. A
// soft contact gives up a share of its own, one after the other: a rod that leans between two walls, 1e6 N along the line of the
// corners on which it stands, left with 709 m/s. Now a body leaves no faster than overlaps part, at sqrt(g L), beside what it falls.
TEST(SoftStep, WhatIsJammedIsNotShotAway) {
  constexpr double kLength = 1.0, kThickness = 0.05;
  for (const double force : {1e2, 1e4, 1e6, 1e8})
    for (const double angle : {0.2, 0.5, 0.7})
      for (const double step : {1.0 / 60.0, 1.0 / 1000.0}) {
        const double across = kLength * std::cos(angle) + kThickness * std::sin(angle);
        const double up = kLength * std::sin(angle) - kThickness * std::cos(angle);
        SceneDef scene = emptySpace(step);
        scene.gravity = -kGravity * Vec3::UnitZ();
        scene.fidelity = Fidelity::Reference;
        for (const double side : {-1.0, 1.0}) {
          scene.bodies.push_back(
              box(side < 0.0 ? "left" : "right", {0.2, 3.0, 3.0}, {side * (0.5 * across + 0.1), 0.0, 0.0}));
          scene.bodies.back().kind = BodyKind::Static;
        }
        scene.bodies.push_back(box("rod", {kLength, kThickness, kThickness}, Vec3::Zero()));
        scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitY()));
        scene.bodies.back().mass = 1.0;
        for (BodyDef& body : scene.bodies) body.material.friction = 2.0;
        World world(scene);
        world.step();
        SavedState jammed = world.captureState();
        for (SavedState::Contact& contact : jammed.contacts)
          for (SavedState::Contact::Point& point : contact.points) {
            point.normal = force;
            point.tangent_W = contact.n_W.x() * force * up / across * Vec3::UnitZ();
          }
        SceneDef soft = world.capture();
        soft.fidelity = Fidelity::Preview;
        World later(soft, jammed);
        for (int k = 1; k <= 3; ++k) {
          later.step();
          EXPECT_LE(stateOf(later, "rod").twist.v_WB.norm(),
                    std::sqrt(kGravity * kThickness) + (1 + k) * kGravity * step)
              << force << " N at " << angle << " rad, step " << k << " of " << step << " s";
        }
      }
}

}  // namespace
}  // namespace rbs::test

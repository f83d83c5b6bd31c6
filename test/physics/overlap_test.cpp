// SPDX-License-Identifier: BSD-3-Clause
// Bodies that an edit has put into each other part, and none is shot out.
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

class Overlap : public ::testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, Overlap, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return fidelityName(info.param); });

// Hard case A65 in other orders of creation. A box that is pushed off the top falls from 3.5 m at most, which
// gives it 2.5 of √(g L); the exact settings once shot one out with 26, by a speed that was to undo a jump of
// its normal.
TEST_P(Overlap, APyramidPartsWhateverTheOrderOfItsBoxes) {
  for (const bool is_shuffled : {false, true}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4 - row; ++column)
        scene.bodies.push_back(
            box("", Vec3::Ones(), Vec3(0.5 * (column - 0.5 * (3 - row)), 0.0, 0.5 + 0.5 * row)));
    if (is_shuffled) std::shuffle(scene.bodies.begin(), scene.bodies.end(), std::mt19937(2));
    scene.fidelity = GetParam();
    World world(ordered(scene));
    double fastest = 0.0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const BodyState& state : world.snapshot().states)
        fastest = std::max(fastest, state.twist.v_WB.norm() + 0.9 * state.twist.w_WB.norm());
    }
    EXPECT_LE(fastest, 2.5 * std::sqrt(kGravity)) << (is_shuffled ? "shuffled" : "row by row");
  }
}

// Of a crowd two columns are left, which are no crowd: they part the short way. A normal that tells no side, as of
// bodies that nearly share a centre, must not send them the long way, through each other.
TEST_P(Overlap, TwoOfACrowdPartTheShortWay) {
  for (const double tilt : {-1.0, -0.5, 0.0, 0.5, 1.0})
    for (const double side : {-1.0, 1.0}) {
      SceneDef scene = emptySpace(1.0 / 60.0);
      scene.fidelity = GetParam();
      const Quat q_WB(Eigen::AngleAxisd(tilt, Vec3::UnitX()));
      const Vec3 offset = q_WB * Vec3(0.0, 0.02 * side, 0.0);
      for (int k = 0; k < 6; ++k) {
        scene.bodies.push_back(box("column_" + std::to_string(k), {0.3, 0.1, 2.0}, (k % 2) * offset));
        scene.bodies.back().pose.q_WB = q_WB;
      }
      World world(ordered(scene));
      world.step();
      for (int k = 0; k < 4; ++k) world.removeBody(world.find("column_" + std::to_string(k)));
      advance(world, 3.0);
      const Vec3 apart = stateOf(world, "column_5").pose.p_WB - stateOf(world, "column_4").pose.p_WB;
      EXPECT_GT(apart.dot(offset.normalized()), 0.09) << tilt << ' ' << side << "; " << apart.transpose();
    }
}

// No faster than a body falls its own length, however deep they are in each other.
TEST_P(Overlap, BoxesPartNoFasterThanTheDepenetrationVelocityLimit) {
  for (const double overlap : {0.1, 0.3, 0.6}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = GetParam();
    scene.bodies.push_back(box("left", Vec3::Ones(), {0.0, 0.0, 0.5}));
    scene.bodies.push_back(box("right", Vec3::Ones(), {1.0 - overlap, 0.1, 0.5}));
    World world(ordered(scene));
    const auto distance = [&] {
      return stateOf(world, "right").pose.p_WB.x() - stateOf(world, "left").pose.p_WB.x();
    };
    for (int k = 0; k < 30; ++k) {
      const double before = distance();
      world.step();
      EXPECT_LE(distance() - before, 1.01 * std::sqrt(kGravity) * scene.step) << overlap << " m, step " << k;
    }
  }
}

// What parts them moves and turns them. That is no impulse: the first step, in which they only part, keeps their angular
// momentum at the exact settings.
TEST_P(Overlap, PartingKeepsTheAngularMomentum) {
  if (GetParam() < Fidelity::Accurate) GTEST_SKIP() << "soft contacts part by impulses";
  for (const double friction : {0.0, 0.5})
    for (const double x : {0.7, 0.8, 0.9}) {
      SceneDef scene = emptySpace(1.0 / 60.0);
      scene.fidelity = GetParam();
      for (const int k : {0, 1}) {
        scene.bodies.push_back(box(k ? "b" : "a", {1.0, 0.6, 0.4}, k * Vec3(x, 0.2, 0.1)));
        scene.bodies.back().material.friction = friction;
        scene.bodies.back().twist.w_WB = (k ? 1.0 : -0.7) * Vec3(0.3, 1.0, -0.5);
      }
      World world(ordered(scene));
      const Vec3 before = world.totals().angular_momentum;
      world.step();
      EXPECT_LE((world.totals().angular_momentum - before).norm(), 1e-12 * before.norm()) << x;
    }
}

// The energy of their lift was taken from the speed along the floor as well: at 0.5 m/s two boxes stopped.
TEST_P(Overlap, WhatPartsOnAFloorWithoutFrictionGlidesOn) {
  for (const double speed : {0.1, 0.5, 5.0})
    for (const double depth : {0.002, 0.01, 0.03})
      for (const Shape& shape :
           {Shape(Box{{0.2, 0.2, 0.2}}), Shape(Cylinder{0.1, 0.1}), Shape(Sphere{0.1})}) {
        SceneDef scene = onFloor(1.0 / 60.0, 0.0);
        scene.fidelity = GetParam();
        scene.bodies.push_back(box("below", {0.4, 0.4, 0.2}, {0.0, 0.0, 0.1 - depth}));
        scene.bodies.push_back(body("above", shape, {0.02, 0.01, 0.3 - 2.0 * depth}));
        for (BodyDef& def : scene.bodies) {
          if (def.kind != BodyKind::Dynamic) continue;
          def.mass = 1.0;
          def.twist.v_WB.x() = speed;
          def.material.friction = 0.4;
        }
        World world(ordered(scene));
        advance(world, 2.0);
        const double mean =
            0.5 * (stateOf(world, "below").twist.v_WB + stateOf(world, "above").twist.v_WB).x();
        EXPECT_NEAR(mean, speed, 1e-9 * speed)
            << shapeName(shape) << ", " << depth << " m at " << speed << " m/s";
      }
}

// Two that meet sink in by what their drift curves, and are parted again in each step. Without friction their momentum changed
// by up to 3 % of a scale m v L in a step, and by 24 % of itself in a run.
TEST_P(Overlap, TwoThatMeetKeepTheirAngularMomentum) {
  if (GetParam() < Fidelity::Accurate) GTEST_SKIP() << "soft contacts part by impulses";
  std::mt19937_64 random(1);
  std::normal_distribution<> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const std::vector<Shape> shapes{Capsule{0.07, 0.1}, Box{{0.26, 0.12, 0.16}}, Cone{0.11, 0.26},
                                  Cylinder{0.1, 0.06}, Sphere{0.1}};
  for (const double friction : {0.0, 0.4})
    for (std::size_t a = 0; a < shapes.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b)
        for (int run = 0; run < 6; ++run) {
          SceneDef scene = emptySpace(1.0 / 60.0);
          scene.fidelity = GetParam();
          for (const int side : {-1, 1}) {
            const Vec3 offset = 0.05 * vector();
            scene.bodies.push_back(body(side < 0 ? "left" : "right", shapes[side < 0 ? a : b],
                                        {0.5 * side, offset.y(), offset.z()}));
            BodyDef& def = scene.bodies.back();
            const Vec3 axis = vector();
            def.pose.q_WB = Quat(Eigen::AngleAxisd(normal(random), axis.normalized()));
            def.twist = {{-1.5 * side, 0.0, 0.0}, 6.0 * vector()};
            def.material.friction = friction;
            def.mass = 1.0;
          }
          World world(ordered(scene));
          const Vec3 first = world.totals().angular_momentum;
          advance(world, 0.7);
          // Nothing may turn a ball without friction, nor give back what its shift has changed.
          const bool with_ball = friction == 0.0 && std::holds_alternative<Sphere>(shapes[a]);
          EXPECT_LE((world.totals().angular_momentum - first).norm(), with_ball ? 1e-6 : 1e-11)
              << shapeName(shapes[a]) << " and " << shapeName(shapes[b]) << ", mu = " << friction << ", run "
              << run;
        }
}

// A heavy block falls on a ball that lies on a plane, at up to 600 m/s. What gets between the two is pushed
// into the plane by half of its size at most.
TEST_P(Overlap, NothingGoesThroughAPlaneByMoreThanHalfItsSize) {
  for (const double speed : {10.0, 100.0, 600.0})
    for (const double step : {1.0 / 1000.0, 1.0 / 60.0, 0.1}) {
      SceneDef scene = onFloor(step, 0.3);
      scene.fidelity = GetParam();
      scene.bodies.push_back(ball("ball", 0.05, {0.0, 0.0, 0.05}));
      scene.bodies.push_back(box("block", {2.0, 2.0, 2.0}, {0.1, 0.0, 1.1001}));
      scene.bodies.back().density = 1e5;
      scene.bodies.back().twist = {{0.0, 0.0, -speed}, {speed, 0.5 * speed, 0.0}};
      World world(ordered(scene));
      double lowest = 0.0;
      for (int k = 0; k < 20; ++k) {
        world.step();
        lowest = std::min(lowest, stateOf(world, "ball").pose.p_WB.z() - 0.05);
      }
      EXPECT_GE(lowest, -0.05 * (1.0 + 1e-9)) << speed << " m/s, steps of " << step << " s";
    }
}

// An edit may leave bodies behind a plane by any length: their points on it are that far from them.
TEST_P(Overlap, APlaneThatIsMovedFarAwayEndsNoStep) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    SceneDef scene = emptySpace(1.0 / 60.0);
    scene.gravity = {1.0, 2.0, 0.0};
    scene.bodies.push_back(floorOf(0.5));
    scene.bodies.back().pose = {
        {0.0, std::pow(10.0, seed % 10), -5.0},
        Quat(
            Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized())};
    scene.bodies.push_back(box("raft", {1.6, 1.2, 0.3}, {0.0, 0.0, 0.6}));
    scene.bodies.push_back(box("post", {0.15, 0.15, 1.5}, {-0.9, -1.2, 0.9}));
    scene.bodies.push_back(body("cask", Capsule{0.15, 0.25}, {0.9, -1.1, 1.4}));
    for (BodyDef& def : scene.bodies) def.material.friction = 0.5;
    for (std::size_t k = 1; k < scene.bodies.size(); ++k)
      scene.bodies[k].twist.v_WB = 0.5 * Vec3(normal(random), normal(random), normal(random));
    scene.fidelity = GetParam();
    World world(scene);
    for (int k = 0; k < 3; ++k) world.step();
    for (const BodyState& state : world.snapshot().states)
      EXPECT_LT(state.twist.v_WB.norm(), 20.0) << "seed " << seed;
  }
}

// A needle that turns by 240 rad in a step meets a plate: no sub-step can follow it, and it left with 10^15
// rad/s.
TEST_P(Overlap, WhatTurnsTooFastForSubStepsGainsNoEnergy) {
  for (const double spin : {1e3, 1e4, 1e5})
    for (const double tilt : {0.1, 0.3, 0.5, 0.8, 1.0, 1.3}) {
      SceneDef scene = emptySpace(0.03);
      scene.fidelity = GetParam();
      scene.bodies.push_back(box("plate", {8.0, 8.0, 0.5}, {0.0, 0.0, -0.25}));
      scene.bodies.back().kind = BodyKind::Static;
      scene.bodies.push_back(body("needle", Cylinder{0.0023, 0.136}, {0.0, 0.0, 1.0}));
      scene.bodies.back().mass = 0.01;
      scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()));
      scene.bodies.back().twist = {{-500.0, 150.0, -630.0}, spin * Vec3(0.97, 0.1, 0.2)};
      World world(ordered(scene));
      const double first = energy(world), fastest = std::sqrt(2.0 * first / 0.01);
      for (int k = 0; k < 10; ++k) {
        const Vec3 before = stateOf(world, "needle").pose.p_WB;
        world.step();
        const std::string where =
            std::to_string(spin) + " rad/s, tilt " + std::to_string(tilt) + ", step " + std::to_string(k);
        ASSERT_LE(energy(world), first * (1.0 + 1e-2)) << where;
        ASSERT_LE((stateOf(world, "needle").pose.p_WB - before).norm(), fastest * scene.step) << where;
      }
    }
}

// Overlaps that were there before are not blamed on an edit, nor are those that a motion makes.
TEST_P(Overlap, OnlyWhatAnEditMadeIsBlamedOnIt) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = GetParam();
  scene.bodies.push_back(box("left", Vec3::Ones(), {0.0, 0.0, 0.5}));
  scene.bodies.push_back(box("right", Vec3::Ones(), {0.5, 0.1, 0.5}));
  scene.bodies.push_back(box("far", Vec3::Ones(), {50.0, 0.0, 0.5}));
  World world(ordered(scene));
  const auto blames = [&] {
    for (const Warning& warning : world.step().warnings)
      if (warning.kind == "overlap") return true;
    return false;
  };
  EXPECT_TRUE(blames()) << "the scene begins with an overlap";
  BodyEdit friction;
  friction.friction = 0.4;
  world.editBody(world.find("far"), friction);
  EXPECT_FALSE(blames());
  BodyEdit moved;
  moved.pose = Pose{{50.0, 0.9, 0.5}, Quat::Identity()};
  world.addBody(box("beside", Vec3::Ones(), {50.0, 1.5, 0.5}));
  EXPECT_FALSE(blames());
  world.editBody(world.find("far"), moved);
  EXPECT_TRUE(blames());
}

// Two part at sqrt(g L) against each other, about, by the sum of their ways, whatever the step and the parts that it is solved in;
// and an overlap that is gone at its end has been one.
TEST_P(Overlap, WhatAnEditPutsIntoAnotherPartsAsFastInAStepOfAnyLength) {
  for (const Shape& shape : {Shape(Capsule{0.06, 0.1}), Shape(Sphere{0.06}), Shape(Box{{0.1, 0.1, 0.3}})})
    for (const double h : {1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0, 1.0 / 20.0, 1.0 / 10.0, 1.0 / 5.0}) {
      SceneDef scene = onFloor(h, 0.5);
      scene.fidelity = GetParam();
      scene.bodies.push_back(box("box", {0.2, 0.2, 0.2}, {0.0, 0.0, 0.1}));
      scene.bodies.push_back(body("other", shape, {3.0, 0.0, 0.16}));
      World world(ordered(scene));
      for (int k = 0; k < 3; ++k) world.step();
      const Vec3 p_W = stateOf(world, "box").pose.p_WB;
      BodyEdit edit;
      edit.pose = Pose{p_W + Vec3(0.01, 0.02, 0.015), Quat::Identity()};
      world.editBody(world.find("other"), edit);
      const StepReport& report = world.step();
      const auto warned = [](const Warning& warning) { return warning.kind == "overlap"; };
      EXPECT_TRUE(std::any_of(report.warnings.begin(), report.warnings.end(), warned)) << h;
      const double way = (stateOf(world, "box").pose.p_WB - p_W).norm() +
                         (stateOf(world, "other").pose.p_WB - edit.pose->p_WB).norm();
      EXPECT_LT(way, 1.8 * std::sqrt(kGravity * 0.12) * h) << h;
    }
}

// Nor does a floor that moves along make them part faster: it moves nothing, as seen from itself.
TEST_P(Overlap, ACrowdOnACarrierPartsAsItDoesAtRest) {
  for (const double speed : {0.0, 3.0, 30.0}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = GetParam();
    scene.bodies[0].kind = BodyKind::Kinematic;
    scene.bodies[0].twist.v_WB.x() = speed;
    for (int k = 0; k < 10; ++k) {
      scene.bodies.push_back(box("", Vec3::Constant(0.2), {0.0, 0.0, 0.1}));
      scene.bodies.back().twist.v_WB.x() = speed;
    }
    World world(ordered(scene));
    double fastest = 0.0;
    for (int k = 0; k < 60; ++k) {
      world.step();
      for (const BodyState& state : world.states())
        fastest = std::max(fastest, (state.twist.v_WB - Vec3(speed, 0.0, 0.0)).norm());
    }
    EXPECT_LT(fastest, 0.4) << speed;
  }
}

// Contacts push bodies off the motions by which pairs were predicted not to meet. Of a house of cards of 2 mm that
// comes down, a card was pushed 21 mm through the floor in a step. The plane stops such a body, and reports it at half of
// the thickness.
TEST(Overlap, NoCardIsPushedThroughTheFloorUnnoticed) {
  constexpr double kThickness = 0.002;
  for (const std::uint32_t sub_steps : {1u, 2u, 4u, 8u}) {
    SceneDef scene = readScene(findScene(RBS_SCENES, "card_house")).scene;
    scene.fidelity = Fidelity::Preview;
    scene.fidelity.sub_steps = sub_steps;
    World world(scene);
    double fastest = 0.0;  // change of a speed by the plane itself, m/s
    for (int k = 0; k < 90; ++k) {
      world.step();
      const Snapshot now = world.snapshot();
      for (const ContactPoint& point : now.contacts) {
        if (std::abs(point.separation + 0.5 * kThickness) > 1e-9) continue;
        const double mass =
            std::max((*now.bodies)[now.find(point.a)].mass, (*now.bodies)[now.find(point.b)].mass);
        fastest = std::max(fastest, point.normal_impulse / mass);
      }
    }
    EXPECT_LE(fastest, 0.3) << sub_steps << " sub-steps";
  }
}

}  // namespace

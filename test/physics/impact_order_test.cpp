// SPDX-License-Identifier: BSD-3-Clause
// Many impacts in one step: in order, at their places, with nothing of the step lost, and the same from each
// side.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

void makeElastic(SceneDef& scene) {
  for (BodyDef& def : scene.bodies) def.material.restitution = 1.0, def.material.friction = 0.0;
}

// Hard case A58. Along each axis the ball runs a triangle wave between -0.9 and 0.9 m. Allowed is 1e-13 of
// the room per impact; the clock's rounding alone makes 1e-12 m of each flight of 1 m.
TEST(ImpactOrder, ABallInAClosedRoomKeepsToItsTimetable) {
  for (const double step : {1.0 / 60.0, 1.0 / 1000.0})
    for (const double speed : {1e3, 1e5}) {
      SceneDef scene = emptySpace(step);
      for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
          Vec3 size = Vec3::Constant(2.4);
          size[k] = 0.2;
          scene.bodies.push_back(box("wall", size, 1.1 * side * Vec3::Unit(k)));
          scene.bodies.back().kind = BodyKind::Static;
          scene.bodies.back().name += std::to_string(scene.bodies.size());
        }
      scene.bodies.push_back(ball("ball", 0.1, Vec3::Zero()));
      const Vec3 v = speed * Vec3(1.0, std::sqrt(2.0), std::sqrt(5.0)).normalized();
      scene.bodies.back().twist.v_WB = v;
      makeElastic(scene);
      World world(ordered(scene));
      unsigned impacts = 0;
      while (impacts < 10000) {
        const StepReport& report = world.step();
        impacts += report.impacts;
        ASSERT_TRUE(report.warnings.empty());
        const BodyState state = stateOf(world, "ball");
        for (int k = 0; k < 3; ++k) {
          const double place = std::fmod(v[k] * world.time() + 0.9, 3.6);
          ASSERT_NEAR(state.pose.p_WB[k], (place > 1.8 ? 3.6 - place : place) - 0.9, 1e-12 + 2e-13 * impacts)
              << "after " << impacts << " impacts";
        }
        ASSERT_NEAR(state.twist.v_WB.norm() / speed, 1.0, 1e-12);
      }
    }
}

// Hard case A59: balls of a cube fall together from all sides at once. What happens to one happens to its
// mirror image.
TEST(ImpactOrder, AnImplosionStaysSymmetric) {
  for (const bool all : {false, true}) {  // the 8 corners, or all 27 places
    SceneDef scene = emptySpace(1.0 / 60.0);
    std::vector<Vec3> places;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (all || (x && y && z)) places.emplace_back(x, y, z);
    for (const Vec3& place : places) {
      scene.bodies.push_back(ball("ball" + std::to_string(scene.bodies.size()), 0.25, place));
      scene.bodies.back().twist.v_WB = -3.0 * place;
    }
    makeElastic(scene);
    World world(ordered(scene));
    const double before = energy(world);
    unsigned impacts = 0;
    for (int k = 0; k < 60; ++k) {
      impacts += world.step().impacts;
      const std::vector<BodyState>& states = world.snapshot().states;
      for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = 0; j < places.size(); ++j)
          for (int axis = 0; axis < 3; ++axis) {
            Vec3 mirrored = places[j], p = states[j].pose.p_WB;
            mirrored[axis] *= -1.0, p[axis] *= -1.0;
            if (mirrored == places[i]) {
              ASSERT_LE((states[i].pose.p_WB - p).norm(), 1e-12) << places.size() << " balls, step " << k;
            }
          }
    }
    EXPECT_GE(impacts, places.size());
    EXPECT_NEAR(energy(world) / before, 1.0, 1e-12);
  }
}

// In one step a fast ball strikes the first of a row, that one the second, and so on. Each ball starts when
// it is struck, where the one before it stops.
TEST(ImpactOrder, ARowOfBallsPassesASpeedOnWithinOneStep) {
  const double radius = 0.1, speed = 1e3, gap = 0.7;
  const int row = 8;
  SceneDef scene = emptySpace(1.0 / 60.0);
  for (int k = row; k >= 0; --k)  // the last comes first in the order of the bodies
    scene.bodies.push_back(
        ball("ball" + std::to_string(k), radius, Vec3(k * (2.0 * radius + gap), 0.0, 0.0)));
  scene.bodies.back().twist.v_WB.x() = speed;
  makeElastic(scene);
  World world(ordered(scene));
  EXPECT_EQ(world.step().impacts, static_cast<unsigned>(row));
  for (int k = 0; k <= row; ++k) {
    const double start = k * (2.0 * radius + gap);
    const double truth = k < row ? start + gap : start + speed * world.time() - row * gap;
    EXPECT_NEAR(stateOf(world, "ball" + std::to_string(k)).pose.p_WB.x(), truth, 1e-12) << k;
  }
}

// What takes no part in impacts is advanced as if there were none.
TEST(ImpactOrder, ImpactsDoNotDisturbWhoTakesNoPart) {
  const auto run = [](bool storm) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    for (int k = 0; k < 3; ++k)
      scene.bodies.push_back(
          box("box" + std::to_string(k), Vec3(0.5, 0.4, 0.3), Vec3(0, 0, 0.16 + 0.32 * k)));
    scene.bodies.push_back(ball("thrown", 0.2, Vec3(-5.0, 0.0, 3.0)));
    scene.bodies.back().twist = {Vec3(1.0, 2.0, 3.0), Vec3(4.0, 5.0, 6.0)};
    if (storm)
      for (int k = 0; k < 10; ++k) {
        scene.bodies.push_back(ball("storm" + std::to_string(k), 0.1, Vec3(0.5 * k, 50.0, 5.0)));
        scene.bodies.back().twist.v_WB = Vec3(k % 2 == 0 ? 90.0 : -90.0, 0.0, 0.0);
        scene.bodies.back().material.restitution = 0.9;
      }
    World world(ordered(scene));
    unsigned impacts = 0;
    for (int k = 0; k < 60; ++k) impacts += world.step().impacts;
    std::vector<BodyState> states;
    for (const char* name : {"box0", "box1", "box2", "thrown"}) states.push_back(stateOf(world, name));
    return std::pair(states, impacts);
  };
  const auto [alone, few] = run(false);
  const auto [beside, many] = run(true);
  EXPECT_GT(many, few + 10);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_EQ(alone[k].pose.p_WB, beside[k].pose.p_WB) << k;
    EXPECT_EQ(alone[k].pose.q_WB.coeffs(), beside[k].pose.q_WB.coeffs()) << k;
    EXPECT_EQ(alone[k].twist.v_WB, beside[k].twist.v_WB) << k;
  }
}

// A ball strikes a row of others that lean on each other and on a kerb; the end of the row strikes a ball
// that falls past it, and that one another. Only the solve of the contacts knows that the end of the row will
// move.
TEST(ImpactOrder, WhatContactsPushIntoEachOtherDoesNotOverlap) {
  for (const Fidelity fidelity : {Fidelity::Accurate, Fidelity::Reference}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.0);
    scene.fidelity = Setting(fidelity);
    scene.gravity = Vec3(-2.0, 0.0, -9.81);
    scene.bodies.push_back(box("kerb", Vec3(0.2, 1.0, 0.2), Vec3(-0.5, 0.0, 0.1)));
    scene.bodies.back().kind = BodyKind::Static;
    const int row = 4;
    for (int k = 0; k < row; ++k) {
      scene.bodies.push_back(ball("row" + std::to_string(k), 0.5, Vec3(k, 0.0, 0.5)));
      scene.bodies.back().material.friction = 0.0;
    }
    World world(ordered(scene));
    for (int k = 0; k < 3; ++k) world.step();
    const auto add = [&](const char* name, double radius, const Vec3& p_WB, const Vec3& v_WB) {
      BodyDef def = ball(name, radius, p_WB);
      def.material.friction = 0.0;
      def.twist.v_WB = v_WB;
      world.addBody(def);
    };
    const double radius = 0.2, gap = 0.001, x = row - 0.5 + radius + gap;
    add("striking", radius, Vec3(-0.5 - radius - gap, 0.0, 0.5), Vec3(100.0, 0.0, 0.0));
    add("falling", radius, Vec3(x, 0.0, 0.5), Vec3::Zero());
    add("next", radius, Vec3(x + 2.0 * radius + gap, 0.0, 0.5), Vec3::Zero());
    world.step();
    const auto between = [&](const char* a, const char* b) {
      return (stateOf(world, b).pose.p_WB - stateOf(world, a).pose.p_WB).norm();
    };
    EXPECT_GE(between("row3", "falling"), 0.5 + radius - 1e-7);
    EXPECT_GE(between("falling", "next"), 2.0 * radius - 1e-7);
    EXPECT_GT(stateOf(world, "next").twist.v_WB.x(), 1.0);
  }
}

// One ball meets two others at one instant: the oldest pair is taken first. e = 0 and equal masses: with c =
// cos 30 deg the first takes c/2 of the speed along its line, and the second what is left of the approach
// along its own.
TEST(ImpactOrder, OfTwoAtOneTimeTheOlderPairIsFirst) {
  for (const bool left_is_older : {true, false}) {
    SceneDef scene = emptySpace(1.0 / 60.0);
    const double side = std::sin(kPi / 6.0), ahead = std::cos(kPi / 6.0);
    const BodyDef left = ball("left", 0.5, Vec3(ahead, side, 0.0)),
                  right = ball("right", 0.5, Vec3(ahead, -side, 0.0));
    scene.bodies = {left_is_older ? left : right, left_is_older ? right : left,
                    ball("shot", 0.5, Vec3(-0.5, 0.0, 0.0))};
    for (BodyDef& def : scene.bodies) def.material.friction = 0.0, def.material.restitution = 1.0;
    scene.bodies[2].twist.v_WB.x() = 6.0;  // meets both after 1/12 s
    scene.bodies[2].pose.p_WB.x() = -0.5;
    World world(scene);
    std::uint32_t impacts = 0;
    for (int k = 0; k < 30; ++k) impacts += world.step().impacts;
    EXPECT_EQ(impacts, 2u);
    const double first = stateOf(world, left_is_older ? "left" : "right").twist.v_WB.norm();
    const double second = stateOf(world, left_is_older ? "right" : "left").twist.v_WB.norm();
    EXPECT_NEAR(first, 6.0 * ahead, 1e-9);
    // The shot goes on at v - (v.n1) n1, whose part along n2 is c v - c v (n1.n2).
    EXPECT_NEAR(second, 6.0 * ahead * (1.0 - (ahead * ahead - side * side)), 1e-9);
  }
}

// The path bulges from the chord between its ends: a ball that is back at its height at the end of a step has
// been at a ceiling meanwhile.
TEST(ImpactOrder, WhatTheBulgeOfAPathReachesIsMet) {
  SceneDef scene = emptySpace(0.5);
  scene.fidelity = Fidelity::Accurate;  // which leaves no slow impact to the contact solver
  scene.gravity = Vec3(0.0, 0.0, -kGravity);
  BodyDef ceiling = box("ceiling", Vec3(2.0, 2.0, 0.1), Vec3(0.0, 0.0, 0.1 + 0.2 + 0.05));
  ceiling.kind = BodyKind::Static;
  scene.bodies = {ceiling, ball("ball", 0.1, Vec3::Zero())};
  for (BodyDef& def : scene.bodies) def.material.restitution = 1.0;
  scene.bodies[1].twist.v_WB.z() = 0.5 * kGravity * scene.step;  // 0.31 m high
  for (const SceneDef& one : inBothOrders(scene)) {
    World world(one);
    EXPECT_EQ(world.step().impacts, 1u);
    EXPECT_LT(stateOf(world, "ball").pose.p_WB.z(), -0.1);
  }
}

// What a ball does in three steps that falls on a field of a hundred boxes, which touch each other.
struct Landing {
  unsigned impacts = 0, deferred = 0;
  double height = 0.0;  // of the ball above the field at the end, m
};

Landing landingOf(double speed, double restitution) {
  constexpr double kSize = 0.4, kRadius = 0.2;
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  for (int k = 0; k < 100; ++k) {
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Constant(kSize),
                               Vec3(kSize * (k % 10), kSize * (k / 10), 0.5 * kSize)));
    scene.bodies.back().density = 1e5;  // the ball is light: an impact hardly moves a box
  }
  World world(ordered(scene));
  for (int k = 0; k < 5; ++k) world.step();
  BodyDef falling = ball("ball", kRadius, Vec3(5.0 * kSize, 5.0 * kSize, kSize + kRadius + 0.02));
  falling.twist.v_WB.z() = -speed;
  falling.material.restitution = restitution;
  const BodyId id = world.addBody(falling);
  Landing landing;
  for (int k = 0; k < 3; ++k) {
    const StepReport& report = world.step();
    landing.impacts += report.impacts, landing.deferred += report.deferred_impacts;
  }
  landing.height = world.pose(id).p_WB.z() - kSize - kRadius;
  return landing;
}

TEST(ImpactOrder, AGroupIsCutOnlyForABodyThatReboundsOrMayPassThrough) {
  const Landing lands = landingOf(3.0, 0.0);
  EXPECT_EQ(lands.impacts, 0u);
  EXPECT_GE(lands.deferred, 1u);
  EXPECT_NEAR(lands.height, 0.0, 5e-3);
  const Landing rebounds = landingOf(3.0, 0.5);
  EXPECT_GE(rebounds.impacts, 1u);
  EXPECT_GT(rebounds.height, 0.02);
  const Landing shot = landingOf(300.0, 0.0);
  EXPECT_GE(shot.impacts, 1u);
  EXPECT_GT(shot.height, -0.1);
}

}  // namespace

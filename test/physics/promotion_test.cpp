// SPDX-License-Identifier: BSD-3-Clause
// Which islands the default setting hands to the exact step: each bound from both sides.
#include "make_scene.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

namespace rbs::test {
namespace {

// Whether the island in contact was solved by the exact step in the last of some steps.
bool isExact(World& world, int steps = 30) {
  for (int k = 1; k < steps; ++k) world.step();
  const StepReport& report = world.step();
  EXPECT_EQ(report.residuals.size(), 1u);
  return !report.residuals.empty() && std::string(report.residuals[0].method) != "soft_step";
}

SceneDef stack(int boxes) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  for (int k = 0; k < boxes; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Ones(), Vec3(0.0, 0.0, 0.5 + k)));
  return scene;
}

// The scene with bodies too fast to be exact at first: they slide on each other, and come to rest by the soft step.
SceneDef sliding(SceneDef scene, double speed = 0.6) {
  for (std::size_t k = 1; k < scene.bodies.size(); ++k)
    scene.bodies[k].twist.v_WB.x() = k % 2 == 0 ? speed : -speed;
  return scene;
}

// They rock for some seconds, too fast at times.
TEST(ChoiceOfSolver, StacksOfSixBecomeExact) {
  for (const int boxes : {2, 5, 6, 7}) {
    World world(ordered(sliding(stack(boxes))));
    EXPECT_EQ(isExact(world, 300), boxes >= 6) << boxes;
  }
}

// The height counts and not the number of contacts: two columns on one slab, which is the first level.
TEST(ChoiceOfSolver, TwoColumnsOfFiveOnASlabBecomeExact) {
  for (const int boxes : {3, 4, 5, 6}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.bodies.push_back(box("slab", Vec3(4.0, 2.0, 1.0), Vec3(0.0, 0.0, 0.5)));
    for (const double x : {-1.0, 1.0})
      for (int k = 0; k < boxes; ++k) scene.bodies.push_back(box("", Vec3::Ones(), Vec3(x, 0.0, 1.5 + k)));
    World world(ordered(sliding(scene)));
    EXPECT_EQ(isExact(world, 60), boxes >= 5) << boxes;
  }
}

// Nothing is known of the forces in what has just been put together: the exact step finds them, and they say
// which method goes on.
TEST(ChoiceOfSolver, WhatIsPutTogetherBeginsExact) {
  for (const int boxes : {1, 2, 3, 4, 5, 6}) {
    World world(ordered(stack(boxes)));
    EXPECT_TRUE(isExact(world, 1)) << boxes;
    EXPECT_EQ(isExact(world, 1), boxes == 1 || boxes >= 4) << boxes;
  }
}

TEST(ChoiceOfSolver, MassRatiosOfTenAreExactInBothOrders) {
  for (const double ratio : {5.0, 9.5, 10.5, 30.0}) {
    SceneDef scene = stack(2);
    scene.bodies[1].mass = 100.0, scene.bodies[2].mass = 100.0 * ratio;
    for (const SceneDef& one : inBothOrders(sliding(scene))) {
      World world(one);
      EXPECT_EQ(isExact(world, 60), ratio >= 10.0) << ratio;
    }
  }
}

// Slenderness is the diameter of the bounding ball over the smallest extent. A cube stands on the rod.
TEST(ChoiceOfSolver, SlendernessOfTenIsExact) {
  for (const double length : {5.0, 9.5, 10.5, 30.0}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.bodies.push_back(box("rod", Vec3(0.1 * length, 0.1, 0.1), Vec3(0.0, 0.0, 0.05)));
    scene.bodies.push_back(box("cube", Vec3::Constant(0.1), Vec3(0.0, 0.0, 0.15)));
    scene.bodies[1].mass = scene.bodies[2].mass = 1.0;
    for (const bool slides : {false, true}) {
      World world(ordered(slides ? sliding(scene) : scene));
      EXPECT_EQ(isExact(world, 60), std::sqrt(length * length + 2.0) >= 10.0) << length;
    }
  }
}

// A stack that is exact stays so down to four boxes.
TEST(ChoiceOfSolver, WhatIsExactStaysSoForAWhile) {
  World world(ordered(stack(6)));
  ASSERT_TRUE(isExact(world));
  for (const int left : {5, 4, 3}) {
    world.removeBody(world.find("box_" + std::to_string(left)));
    EXPECT_EQ(isExact(world, 3), left >= 4) << left;
  }
}

TEST(ChoiceOfSolver, WhatMovesIsSoft) {
  SceneDef scene = stack(6);
  for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
  World world(ordered(sliding(scene, 1.0)));
  EXPECT_FALSE(isExact(world, 5));
}

// Cubes that are let go a little above each other fall for a step before they meet. By the soft step, a tower of 18 sank in by
// 85 mm and slid by 25 mm.
TEST(ChoiceOfSolver, ATowerWhoseBlocksFallOnEachOtherIsExact) {
  SceneDef scene = onFloor(1.0 / 30.0, 0.5);
  for (int k = 0; k < 18; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), {0.1, 0.1, 0.1}, {0.0, 0.0, 0.05 + 0.1 * k}));
  for (std::size_t k = 1; k < scene.bodies.size(); ++k)
    scene.bodies[k].pose.p_WB.z() += 2e-5 * static_cast<double>(k);
  const Vec3 above = scene.bodies.back().pose.p_WB;
  World world(ordered(scene));
  double lowest = above.z(), sideways = 0.0;
  for (int k = 0; k < 150; ++k) {
    world.step();
    const Vec3 p_W = stateOf(world, scene.bodies.back().name).pose.p_WB;
    lowest = std::min(lowest, p_W.z());
    sideways = std::max(sideways, (p_W - above).head<2>().norm());
  }
  EXPECT_GT(lowest, above.z() - 0.04);  // 0.022 m
  EXPECT_LT(sideways, 2e-3);            // 5e-4 m
}

constexpr int kTowers = 60;

SceneDef towers(double step, int blocks, double size) {
  SceneDef scene = onFloor(step, 0.5);
  for (int tower = 0; tower < kTowers; ++tower)
    for (int k = 0; k < blocks; ++k)
      scene.bodies.push_back(box("", Vec3::Constant(size), {5.0 * size * tower, 0.0, size * (k + 0.5)}));
  return scene;
}

// Takes a step, and counts the islands that the exact step solved in it.
int stepExactly(World& world) {
  const std::vector<IslandResiduals> islands = world.step().residuals;
  const auto isExact = [](const IslandResiduals& r) { return std::string(r.method) != "soft_step"; };
  return static_cast<int>(std::count_if(islands.begin(), islands.end(), isExact));
}

// Sixty towers whose cubes slide on each other at first: 16 of them have no more than 300 pairs. The soft step takes what is left as
// long as it moves.
TEST(ChoiceOfSolver, OfManyTowersThatMoveSomeAreExact) {
  World world(ordered(sliding(towers(1.0 / 30.0, 18, 0.1), 0.3)));
  int least = kTowers;
  for (int step = 0; step < 60; ++step) {
    const int exact = stepExactly(world);
    if (exact > 0) least = std::min(least, exact);
  }
  EXPECT_GE(least, 16);
  EXPECT_LT(least, kTowers);
  for (const BodyState& state : world.snapshot().states) EXPECT_LT(std::abs(state.pose.p_WB.y()), 0.01);
}

// Towers that are exact for their height stay so where their gravity turns, however many there are: what has lost its support is
// solved exactly in small numbers alone.
TEST(ChoiceOfSolver, OfManyTowersWhoseGravityTurnsAllAreExact) {
  World world(towers(1.0 / 60.0, 7, 0.2));
  for (int k = 0; k < 30; ++k) world.step();
  world.setGravity({5.0, 0.0, 5.0});
  EXPECT_EQ(stepExactly(world), kTowers);
}

// A body that slides, tips over or rolls costs little more by a direct solve than by sub-steps, as long as they are few.
TEST(ChoiceOfSolver, WhatSlidesTipsOrRollsAloneIsExactWhereTheyAreFew) {
  const auto exactOf = [](const Shape& shape, const Twist& twist, int bodies) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.2);
    for (int k = 0; k < bodies; ++k) {
      scene.bodies.push_back(body("body_" + std::to_string(k), shape, {0.0, 3.0 * k, 0.5}));
      scene.bodies.back().twist = twist;
    }
    World world(ordered(scene));
    for (int k = 0; k < 9; ++k) world.step();
    int exact = 0;
    for (const IslandResiduals& island : world.step().residuals)
      exact += std::string(island.method) != "soft_step";
    return exact;
  };
  const Shape cube = Box{Vec3::Ones()}, ball = Sphere{0.5};
  const Twist slides{{3.0, 0.0, 0.0}, Vec3::Zero()}, rolls{{3.0, 0.0, 0.0}, {0.0, 6.0, 0.0}};
  EXPECT_EQ(exactOf(cube, slides, 1), 1);
  EXPECT_EQ(exactOf(ball, rolls, 1), 1);
  EXPECT_EQ(exactOf(ball, slides, 7), 7);
  EXPECT_EQ(exactOf(ball, rolls, 30), 30);
  EXPECT_EQ(exactOf(ball, rolls, 40), 30);
  EXPECT_EQ(exactOf(cube, {{1.0, 0.0, 0.0}, {0.0, 3.0, 0.0}}, 1), 1) << "it tips";
  EXPECT_EQ(exactOf(Cylinder{0.5, 0.5}, {{1.0, 0.0, 0.0}, {0.0, 3.0, 0.0}}, 1), 0) << "its rim comes round";
}

// What lies on something that moves is as calm as what lies on the ground: stacks of 6 become exact there as well. Smaller ones
// stay exact, as they are begun; by the soft step they would sag, which counts as a jolt (carrier_test.cpp).
TEST(ChoiceOfSolver, StacksOnACarrierThatMovesAreExact) {
  const Twist still, along{{1.0, -0.4, 0.0}, Vec3::Zero()}, up{{0.0, 0.0, 0.7}, Vec3::Zero()},
      turning{Vec3::Zero(), {0.0, 0.0, 1.5}};
  for (const Twist& motion : {still, along, up, turning})
    for (const int boxes : {2, 5, 6, 20}) {
      SceneDef scene = stack(boxes);
      scene.bodies[0] = box("floor", {8.0, 8.0, 1.0}, {0.0, 0.0, -0.5});
      scene.bodies[0].kind = BodyKind::Kinematic;
      for (BodyDef& def : scene.bodies) def.twist = motion;
      World world(ordered(scene));
      const bool moves = !motion.v_WB.isZero(0.0) || !motion.w_WB.isZero(0.0);
      EXPECT_EQ(isExact(world), moves || boxes >= 4) << boxes << " at " << motion.v_WB.transpose();
    }
}

// So is a stack that glides on its carrier as one: on a sled, it knows of no motion. A tower of 20 fell, from 0.5 m/s on.
TEST(ChoiceOfSolver, WhatMovesTogetherIsExact) {
  for (const double carrier : {0.0, 0.5})
    for (const double speed : {0.2, 1.0, 20.0})
      for (const int boxes : {6, 20}) {
        SceneDef scene = stack(boxes);
        scene.bodies[0].material.friction = 0.0;
        scene.bodies[0].kind = BodyKind::Kinematic;
        scene.bodies[0].twist.v_WB.x() = carrier;
        for (std::size_t k = 1; k < scene.bodies.size(); ++k)
          scene.bodies[k].twist.v_WB.x() = carrier + speed;
        World world(ordered(scene));
        EXPECT_TRUE(isExact(world, 120)) << carrier << ", " << speed << " m/s";
        for (std::size_t k = 1; k < scene.bodies.size(); ++k) {
          const BodyDef& def = scene.bodies[k];
          const Vec3 expected(2.0 * (carrier + speed), 0.0, def.pose.p_WB.z());
          EXPECT_LT((stateOf(world, def.name).pose.p_WB - expected).norm(), 1e-6)
              << carrier << ", " << speed << " m/s";
        }
      }
}

// The ratio counts in the first step of a contact, and so it does where nothing but a mass has changed: in one soft step the heavy
// body would sink into the light one.
TEST(ChoiceOfSolver, WhatIsAddedOrEditedCountsAtOnce) {
  for (const double ratio : {3.0, 30.0, 1000.0}) {
    World added(ordered(stack(2)));
    ASSERT_FALSE(isExact(added));
    BodyDef heavy = box("heavy", Vec3::Ones(), {0.0, 0.0, 2.5});
    heavy.mass = ratio * 1000.0;
    added.addBody(heavy);
    EXPECT_EQ(isExact(added, 1), ratio >= 10.0) << ratio;

    World edited(ordered(stack(3)));
    ASSERT_FALSE(isExact(edited));
    BodyEdit edit;
    edit.mass = ratio * 1000.0;
    edited.editBody(edited.find("box_2"), edit);
    EXPECT_EQ(isExact(edited, 1), ratio >= 10.0) << ratio;
  }
}

// Towers of twenty. What stands beside another without touching it is no part of its group, though both would touch if one
// of them leaned. Otherwise three of them would have too many pairs for a direct solve, and fall.
TEST(ChoiceOfSolver, WhatStandsBesideAnotherIsAGroupOfItsOwn) {
  for (const double size : {0.03, 0.1, 2.0})
    for (const double gap : {1e-4, 1e-2, 0.03})
      for (const double step : {1.0 / 240.0, 1.0 / 60.0, 1.0 / 20.0}) {
        SceneDef scene = onFloor(step, 0.5);
        for (int k = 0; k < 180; ++k) {
          const int tower = k / 20;
          const double pitch = (1.0 + gap) * size;
          scene.bodies.push_back(box("block_" + std::to_string(k), Vec3::Constant(size),
                                     {pitch * (tower % 3), pitch * (tower / 3), (0.5 + k % 20) * size}));
        }
        World world(ordered(scene));
        const Snapshot before = world.snapshot();
        for (int k = 0; k < 60; ++k) {
          const StepReport& report = world.step();
          if (k == 0) continue;
          ASSERT_EQ(report.residuals.size(), 9u) << size << " m, gap " << gap << ", step of " << step << " s";
        }
        const Snapshot after = world.snapshot();
        for (std::size_t k = 0; k < after.states.size(); ++k)
          ASSERT_LT((after.states[k].pose.p_WB - before.states[k].pose.p_WB).norm(), 1e-6 * size)
              << size << " m, gap " << gap << ", step of " << step << " s, body " << k;
      }
}

// Sheets so thin that each is near many others: only the next ones count.
TEST(ChoiceOfSolver, AThinSheetTouchesItsNeighboursAlone) {
  for (const double thickness : {3e-4, 1e-3})
    for (const double step : {1.0 / 240.0, 1.0 / 60.0, 1.0 / 20.0}) {
      SceneDef scene = onFloor(step, 0.3);
      for (int k = 0; k < 52; ++k)
        scene.bodies.push_back(
            box("sheet_" + std::to_string(k), {0.063, 0.088, thickness}, {0.0, 0.0, (0.5 + k) * thickness}));
      World world(ordered(scene));
      for (double t = 0.0; t < 1.0; t += step) world.step();
      for (int k = 0; k < 52; ++k)
        ASSERT_NEAR(world.pose(world.find("sheet_" + std::to_string(k))).p_WB.z(), (0.5 + k) * thickness,
                    1e-3 * thickness)
            << thickness << " m, step of " << step << " s, sheet " << k;
    }
}

// What rests beside others is on its own only while it rests: a tower that is knocked over takes the next one with it.
TEST(ChoiceOfSolver, WhatStandsBesideAnotherIsStruckByIt) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = fidelity;
    for (int k = 0; k < 10; ++k)
      scene.bodies.push_back(
          box("block_" + std::to_string(k), Vec3::Ones(), {1.001 * (k / 5), 0.0, 0.5 + k % 5}));
    World world(ordered(scene));
    for (int k = 0; k < 30; ++k) world.step();
    for (int k = 2; k < 5; ++k)
      world.applyImpulse(world.find("block_" + std::to_string(k)), Vec3(2000.0 * k, 0.0, 0.0),
                         world.pose(world.find("block_" + std::to_string(k))).p_WB);
    double most = 0.0;
    for (int k = 0; k < 120; ++k) {
      world.step();
      for (int upper = 0; upper < 5; ++upper)
        for (int lower = 5; lower < 10; ++lower) {
          const auto at = [&](int one) { return world.pose(world.find("block_" + std::to_string(one))); };
          most = std::max(most, -gap(Box{Vec3::Ones()}, at(upper), Box{Vec3::Ones()}, at(lower)).distance);
        }
    }
    EXPECT_GT(world.pose(world.find("block_9")).p_WB.x(), 1.5) << fidelityName(fidelity);
    EXPECT_LT(most, 0.05) << fidelityName(fidelity);
  }
}

// Slow bodies that are carried meet as they should, whatever the gap was when they came near.
TEST(ChoiceOfSolver, WhatRestsBesideAnotherIsMetByIt) {
  for (const Fidelity fidelity : kFidelities)
    for (const bool impacts : {true, false})
      for (const double speed : {1e-3, 0.02, 0.1}) {
        SceneDef scene = onFloor(1.0 / 60.0, 0.0);
        scene.fidelity = fidelity;
        if (!impacts) scene.effects[Effect::Impacts] = false;
        for (const double x : {0.0, 1.0 + 20.3 * speed * scene.step}) {
          scene.bodies.push_back(box(x == 0.0 ? "moving" : "resting", Vec3::Ones(), {x, 0.0, 0.5}));
          scene.bodies.back().material.friction = 0.0;
          scene.bodies.back().twist.v_WB.x() = x == 0.0 ? speed : 0.0;
        }
        World world(ordered(scene));
        for (int k = 0; k < 60; ++k) world.step();
        const BodyState moving = stateOf(world, "moving"), resting = stateOf(world, "resting");
        const Vec3 apart = resting.pose.p_WB - moving.pose.p_WB;
        const std::string where = std::string(fidelityName(fidelity)) + ", " + std::to_string(speed) + " m/s";
        EXPECT_NEAR(moving.twist.v_WB.x(), 0.5 * speed, 0.01 * speed) << where;
        EXPECT_NEAR(resting.twist.v_WB.x(), 0.5 * speed, 0.01 * speed) << where;
        EXPECT_NEAR(apart.x(), 1.0, 0.5 * speed * scene.step) << where;
      }
}

// Nor is it past them when its support is taken away, or when contacts alone push it: no impact tells of that.
TEST(ChoiceOfSolver, WhatRestsBesideAnotherIsMetWhenItLosesItsSupport) {
  for (const Fidelity fidelity : kFidelities)
    for (const double step : {1.0 / 60.0, 1.0 / 20.0, 1.0 / 10.0}) {
      SceneDef scene = onFloor(step, 0.5);
      scene.fidelity = fidelity;
      const auto hold = [&](const std::string& name, const Vec3& p_W, BodyKind kind) {
        scene.bodies.push_back(box(name, {0.01, 0.1, 0.02}, p_W));
        scene.bodies.back().kind = kind;
      };
      hold("plate", {0.0, 0.0, 0.5}, BodyKind::Kinematic);
      for (const double side : {-1.0, 1.0})
        hold(side < 0.0 ? "left" : "right", {0.0101 * side, 0.0, 0.4985}, BodyKind::Static);
      scene.bodies.push_back(box("box", Vec3::Constant(0.02), {0.0, 0.0, 0.52}));
      World world(ordered(scene));
      for (int k = 0; k < 20; ++k) world.step();
      BodyEdit falls;
      falls.twist = Twist{{0.0, 0.0, -2.0}, Vec3::Zero()};
      world.editBody(world.find("plate"), falls);
      for (int k = 0; k < 6; ++k) {
        world.step();
        ASSERT_GT(stateOf(world, "box").pose.p_WB.z(), 0.518)
            << fidelityName(fidelity) << ", " << step << " s";
      }
    }
}

TEST(ChoiceOfSolver, WhatRestsBesideAnotherIsPushedByIt) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.3);
    scene.fidelity = fidelity;
    scene.bodies.push_back(box("cube", Vec3::Constant(5.0), {0.0, 0.0, 2.5}));
    scene.bodies.push_back(box("small", Vec3::Constant(0.02), {2.511, 0.0, 0.01}));
    scene.bodies.push_back(box("pusher", {1.0, 5.0, 5.0}, {-3.0, 0.0, 2.5}));
    scene.bodies.back().kind = BodyKind::Kinematic;
    World world(ordered(scene));
    for (int k = 0; k < 20; ++k) world.step();
    BodyEdit pushes;
    pushes.twist = Twist{{5.0, 0.0, 0.0}, Vec3::Zero()};
    world.editBody(world.find("pusher"), pushes);
    for (int k = 0; k < 4; ++k) {
      world.step();
      const double apart =
          stateOf(world, "small").pose.p_WB.x() - stateOf(world, "cube").pose.p_WB.x() - 2.51;
      EXPECT_GT(apart, -0.02) << fidelityName(fidelity) << ", step " << k;
    }
  }
}

// A wall of bricks n wide at its foot has n (n + 1)/2 bricks and n + n (n - 1) pairs.
TEST(ChoiceOfSolver, ManyPairsAreSoft) {
  for (const int width : {8, 14}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    for (int row = 0; row < width; ++row)
      for (int k = 0; k < width - row; ++k)
        scene.bodies.push_back(
            box("", Vec3(1.0, 0.5, 0.5), Vec3(1.1 * (k + 0.5 * row), 0.0, 0.25 + 0.5 * row)));
    World world(ordered(scene));
    EXPECT_EQ(isExact(world, 10), width == 8) << width;
  }
}

// What stands alone and is struck from above stays, without rebound: on a body as on a plane.
TEST(ChoiceOfSolver, WhatStandsAloneOnABodyStaysWhenItIsStruck) {
  for (const Shape& shape :
       {Shape(Cylinder{0.1, 0.1}), Shape(Cone{0.1, 0.2}), Shape(Box{Vec3::Constant(0.2)})})
    for (const double h : {1.0 / 60.0, 1.0 / 240.0}) {
      SceneDef scene;
      scene.step = h;
      scene.bodies.push_back(box("floor", {2.0, 2.0, 1.0}, {0.0, 0.0, -0.5}));
      scene.bodies.back().kind = BodyKind::Static;
      scene.bodies.push_back(
          body("body", shape, {0.0, 0.0, std::holds_alternative<Cone>(shape) ? 0.05 : 0.1}));
      World world(ordered(scene));
      advance(world, 0.5);
      const BodyId id = world.find("body");
      for (const BodyDescription& one : *world.bodies())
        if (one.id == id)
          world.applyImpulse(id, {0.0, 0.0, -2.0 * one.mass}, stateOf(world, "body").pose.p_WB);
      for (int k = 0; k < 3; ++k) world.step();
      const Twist after = stateOf(world, "body").twist;
      EXPECT_LT(std::abs(after.v_WB.z()), 1e-6) << h;
      EXPECT_LT(after.w_WB.norm(), 1e-6) << h;
    }
}

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// Which islands the default setting hands to the exact step: each bound from both sides.
#include "make_scene.h"

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

// The scene with bodies too fast to be exact at first: they slide, and come to rest by the soft step.
SceneDef sliding(SceneDef scene) {
  for (BodyDef& def : scene.bodies)
    if (def.kind == BodyKind::Dynamic) def.twist.v_WB.x() = 0.6;
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
    EXPECT_EQ(isExact(world, 1), boxes >= 4) << boxes;
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

// Slenderness is the diameter of the bounding ball over the smallest extent.
TEST(ChoiceOfSolver, SlendernessOfTenIsExact) {
  for (const double length : {5.0, 9.5, 10.5, 30.0}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.bodies.push_back(box("rod", Vec3(0.1 * length, 0.1, 0.1), Vec3(0.0, 0.0, 0.05)));
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
  for (std::size_t k = 1; k < scene.bodies.size(); ++k) scene.bodies[k].twist.v_WB.x() = 1.0;
  World world(ordered(scene));
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

// A body that slides on its carrier is not.
TEST(ChoiceOfSolver, WhatMovesOnItsCarrierIsSoft) {
  for (const double carrier : {0.0, 0.5, 1.0}) {
    SceneDef scene = stack(6);
    for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
    scene.bodies[0].kind = BodyKind::Kinematic;
    scene.bodies[0].twist.v_WB.x() = carrier;
    for (std::size_t k = 1; k < scene.bodies.size(); ++k) scene.bodies[k].twist.v_WB.x() = carrier - 1.0;
    World world(ordered(scene));
    EXPECT_FALSE(isExact(world, 5)) << carrier;
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

}  // namespace
}  // namespace rbs::test

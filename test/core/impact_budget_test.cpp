// SPDX-License-Identifier: BSD-3-Clause
// What the impacts of a step may cost: the counts themselves, and a pile that many join at times of their own.
#include "step/impact_budget.h"

#include "make_scene.h"
#include "solver_scene.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using test::ball;
using test::body;
using test::onFloor;
using test::stateOf;

constexpr double kInterval = 1e-3;  // s

TEST(InelasticCollapse, IsTheSeventhImpactInQuickSuccession) {
  InelasticCollapse collapse(kInterval);
  for (int k = 0; k < 6; ++k) EXPECT_FALSE(collapse.count(1, 2, 1e-4 * k)) << k;
  EXPECT_TRUE(collapse.count(1, 2, 6e-4));
  EXPECT_FALSE(collapse.count(1, 3, 6e-4)) << "another pair";
}

TEST(InelasticCollapse, BeginsAnewAfterAPause) {
  InelasticCollapse collapse(kInterval);
  for (int k = 0; k < 6; ++k) collapse.count(1, 2, 1e-4 * k);
  for (int k = 0; k < 6; ++k) EXPECT_FALSE(collapse.count(1, 2, 1.0 + 1e-4 * k)) << k;
}

TEST(InelasticCollapse, EndsAThousandSlowImpacts) {
  InelasticCollapse collapse(kInterval);
  for (int k = 0; k < 1000; ++k) ASSERT_FALSE(collapse.count(1, 2, 2.0 * kInterval * k)) << k;
  EXPECT_TRUE(collapse.count(1, 2, 2000.0 * kInterval));
}

TEST(InelasticCollapse, KnowsThePairsOfTheStep) {
  InelasticCollapse collapse(kInterval);
  collapse.count(1, 2, 0.0);
  EXPECT_TRUE(collapse.knows(1, 2));
  EXPECT_FALSE(collapse.knows(1, 3));
}

// Four balls; the first two and the last two may meet, and each pair is a contact.
struct TwoPairs {
  test::SolverScene scene;
  DisjointSets sets{4};

  TwoPairs() {
    for (Index i = 0; i < 4; ++i)
      scene.store.bodies.append(BodyId{i + 1u}, ball("b" + std::to_string(i), 0.5, {0.9 * i, 0.0, 0.0}));
    scene.begin(0.01);
    for (const Index i : {0u, 2u}) scene.touch(i, i + 1), sets.unite(i, i + 1);
  }
};

TEST(ImpactBudget, OfASetIsForIt) {
  TwoPairs pairs;
  ImpactBudget budget(pairs.scene.context, pairs.sets);
  EXPECT_FALSE(budget.takeCut(0, 1, 261));
  EXPECT_TRUE(budget.takeCut(0, 1, 260)) << "256, and 4 for its contact; what was refused is left";
  EXPECT_FALSE(budget.takeCut(1, 0, 1));
  EXPECT_TRUE(budget.takeCut(2, 3, 260)) << "another set";
  EXPECT_TRUE(budget.takeJoin(0, 1, 260)) << "another kind";
  EXPECT_FALSE(budget.takeJoin(0, 1, 1));
  EXPECT_FALSE(budget.takeLanding(0, 1, 257)) << "contacts would stop it as well";
  EXPECT_TRUE(budget.takeLanding(0, 1, 256));
}

TEST(ImpactBudget, IsTheSameForAllSetsAtTheExactSettings) {
  TwoPairs pairs;
  pairs.scene.context.step.solver.exact = true;
  ImpactBudget budget(pairs.scene.context, pairs.sets);
  EXPECT_TRUE(ImpactBudget::couldCutExact(512));
  EXPECT_FALSE(ImpactBudget::couldCutExact(513));
  EXPECT_FALSE(budget.takeCut(0, 1, 513));
  EXPECT_TRUE(budget.takeCut(0, 1, 512));
  EXPECT_FALSE(budget.takeCut(0, 1, 1));
  EXPECT_TRUE(budget.takeCut(2, 3, 512));
  EXPECT_TRUE(budget.takeJoin(0, 1, 512));
  EXPECT_FALSE(budget.takeJoin(0, 1, 1));
  EXPECT_FALSE(budget.takeLanding(0, 1, 257));
}

TEST(ImpactBudget, OfSetsThatBecomeOneAddsUp) {
  TwoPairs pairs;
  ImpactBudget budget(pairs.scene.context, pairs.sets);
  EXPECT_TRUE(budget.takeCut(1, 2, 520));
  EXPECT_EQ(pairs.sets.root(3), 0u);
  EXPECT_FALSE(budget.takeCut(3, 0, 1));
  EXPECT_TRUE(budget.takeJoin(3, 0, 520));
  EXPECT_TRUE(budget.takeLanding(3, 0, 512));
  EXPECT_FALSE(budget.takeLanding(3, 0, 1));
}

TEST(ImpactBudget, EndsImpactsThatLoseEnergyAndQueries) {
  TwoPairs pairs;
  ImpactBudget budget(pairs.scene.context, pairs.sets);
  for (int k = 0; k < 2000 + 4 * 200; ++k) ASSERT_TRUE(budget.takeImpact(true)) << k;
  EXPECT_FALSE(budget.takeImpact(true));
  EXPECT_TRUE(budget.takeImpact(false));
  budget.chargeQueries(100'000 + 4 * 400 - 20);
  EXPECT_TRUE(budget.takeImpact(false));
  budget.chargeImpact([] {});
  EXPECT_TRUE(budget.takeImpact(false)) << "an impact without queries is free";
  budget.chargeImpact([&] { budget.chargeQueries(1); });
  EXPECT_FALSE(budget.takeImpact(false));
}

// Pairs of balls meet above a row of cylinders that lie side by side, each pair at a time of its own, and stay together. Then
// each joins the row within the same step, the later ones later. The row is one island. If it were solved up to the time of
// each pair, a step would ask 14 times for the nearest points of each of its pairs.
TEST(ImpactBudget, APileIsNotSolvedAnewForEachThatJoinsIt) {
  constexpr int kRow = 300, kPairs = 60;
  constexpr double kSize = 0.1, kRadius = 0.04, kSpeed = 6.0;
  for (const Fidelity fidelity : {Fidelity::Preview, Fidelity::Interactive}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = fidelity;
    for (int k = 0; k < kRow; ++k)
      scene.bodies.push_back(
          body("c" + std::to_string(k), Cylinder{kSize / 2, kSize / 2}, {k * kSize, 0.0, kSize / 2}));
    for (int k = 0; k < kPairs; ++k) {
      const double x = 5 * k * kSize, z = kSize + kRadius + 0.03 + 0.0005 * k;
      const double gap = 0.004 * (1.0 + double(k) / kPairs);
      scene.bodies.push_back(ball("a" + std::to_string(k), kRadius, {x, 0.0, z}));
      scene.bodies.back().twist.v_WB.z() = -kSpeed;
      scene.bodies.push_back(ball("b" + std::to_string(k), kRadius, {x, 0.0, z + 2 * kRadius + gap}));
      scene.bodies.back().twist.v_WB.z() = -kSpeed - 2.0;
    }
    World world(scene);
    const double energy = world.totals().kinetic_energy + world.totals().potential_energy;
    const StepReport report = world.step();
    EXPECT_GE(report.impacts, static_cast<std::uint32_t>(kPairs)) << "the pairs meet in the air";
    EXPECT_GE(report.deferred_impacts, static_cast<std::uint32_t>(kPairs)) << "the row stops them";
    EXPECT_LT(report.axis_queries, 7u * report.pairs);
    for (int k = 0; k < 60; ++k) {
      EXPECT_LE(world.totals().kinetic_energy + world.totals().potential_energy, energy) << k;
      world.step();
    }
    for (const BodyState& state : world.snapshot().states)
      EXPECT_GT(state.pose.p_WB.z(), -0.01) << "nothing goes through the floor";
  }
}

// A plank on 140 balls: more pairs than landings may cut.
constexpr int kSupports = 140;
constexpr double kUnder = 0.05, kThick = 0.1, kTop = 2 * kUnder + kThick, kStep = 1.0 / 60.0;  // m, s

SceneDef plankOnBalls() {
  SceneDef scene = onFloor(kStep, 0.5);
  scene.fidelity = Fidelity::Accurate;
  scene.bodies.front() = body("floor", Box{{60.0, 60.0, 1.0}}, {0.0, 0.0, -0.5});
  scene.bodies.front().kind = BodyKind::Kinematic;
  scene.bodies.push_back(
      body("plank", Box{{2.2 * kUnder * kSupports, 0.5, kThick}}, {0.0, 0.0, kTop - kThick / 2}));
  for (int k = 0; k < kSupports; ++k)
    scene.bodies.push_back(ball("under" + std::to_string(k), kUnder,
                                {2.2 * kUnder * (k + 0.5 - kSupports / 2), k % 2 ? 0.2 : -0.2, kUnder}));
  return scene;
}

// A ball that begins to come down on the plank at this speed, m/s, and at its own pace gets there in the fourth step.
BodyDef landing(const std::string& name, double x, double higher, double speed = 1.0) {
  constexpr double kRadius = 0.1;
  BodyDef falls = ball(name, kRadius, {x, 0.0, kTop + kRadius + 3.0 * kStep * speed + higher});
  falls.twist.v_WB.z() = -speed;
  return falls;
}

// Balls come down on the plank, each at a time of its own, and one right behind each. None rebounds, so that contacts stop them in
// the solve of the step. They know of the second ball, which was predicted to follow the first through the plank. It is the same
// where all goes along with the floor.
TEST(ImpactBudget, WhatLandsOnALargeGroupIsStoppedByContacts) {
  constexpr int kLanding = 10;
  for (const double carried : {0.0, 5.0}) {
    SceneDef scene = plankOnBalls();
    for (int k = 0; k < kLanding; ++k) {
      const double x = 1.4 * (k - 4.5), higher = 0.0015 * k;
      scene.bodies.push_back(landing("a" + std::to_string(k), x, higher));
      scene.bodies.push_back(landing("b" + std::to_string(k), x, higher + 0.21));
    }
    for (BodyDef& of : scene.bodies) of.twist.v_WB.y() += carried;
    World world(scene);
    std::uint32_t left = 0, taken = 0;
    for (int k = 0; k < 8; ++k) {
      const StepReport report = world.step();
      left += report.deferred_impacts, taken += report.impacts;
      EXPECT_EQ(report.repeated, 0u) << "step " << k << ", " << carried << " m/s";
      EXPECT_LT(report.deepest_penetration, 1e-6) << "step " << k << ", " << carried << " m/s";
    }
    EXPECT_GE(left, static_cast<std::uint32_t>(kLanding)) << carried << " m/s";
    EXPECT_LT(taken, 5u) << "the group is hardly cut for them: six times by the budget of rebounds";
  }
}

// It is the same where all goes along with the floor: what rebounds past the budget does so where it is on the plank.
TEST(ImpactBudget, WhatReboundsFromALargeGroupDoesSo) {
  for (const double carried : {0.0, 5.0}) {
    SceneDef scene = plankOnBalls();
    for (int k = 0; k < 3; ++k) {
      scene.bodies.push_back(landing("a" + std::to_string(k), k - 1.0, 0.005 * k));
      scene.bodies.back().material.restitution = 0.9;
    }
    for (BodyDef& of : scene.bodies) of.twist.v_WB.y() += carried;
    World world(scene);
    for (int k = 0; k < 6; ++k) world.step();
    const double plank_y = stateOf(world, "plank").pose.p_WB.y();
    for (int k = 0; k < 3; ++k) {
      const BodyState state = stateOf(world, "a" + std::to_string(k));
      EXPECT_GT(state.twist.v_WB.z(), 0.4) << "0.9 of 1 m/s, less the fall since; " << carried << " m/s";
      EXPECT_NEAR(state.pose.p_WB.y(), plank_y, 1e-3) << k << ", " << carried << " m/s";
    }
  }
}

// Two balls lie side by side on the plank, between others that come down on it and spend its budget, and a third strikes the first
// of the two towards the second, later in the step. The first may not be brought to that time through the second.
TEST(ImpactBudget, WhatIsStruckInALargeGroupMeetsItsNeighbourFirst) {
  constexpr double kRadius = 0.1, kGap = 1e-3;
  for (const bool mirrored : {false, true}) {
    SceneDef scene = plankOnBalls();
    const double side = mirrored ? -1.0 : 1.0;
    std::vector<BodyDef> balls = {
        ball("first", kRadius, {0.0, 0.0, kTop + kRadius}),
        ball("second", kRadius, {side * (2 * kRadius + kGap), 0.0, kTop + kRadius})};
    balls.push_back(
        ball("strikes", kRadius, {-side * (2 * kRadius + 2.9 * kStep * 6.0), 0.0, kTop + kRadius + 0.01}));
    balls.back().twist.v_WB.x() = side * 6.0;
    if (mirrored) std::swap(balls.front(), balls[1]);
    for (BodyDef& of : balls) of.material.restitution = 0.9, scene.bodies.push_back(of);
    for (int k = 0; k < 6; ++k) {
      scene.bodies.push_back(landing("a" + std::to_string(k), 2.0 + 0.5 * k, 0.001 * k));
      scene.bodies.back().material.restitution = 0.9;
    }
    World world(scene);
    double least = kGap;
    for (int k = 0; k < 6; ++k) {
      world.step();
      const Vec3 apart = stateOf(world, "second").pose.p_WB - stateOf(world, "first").pose.p_WB;
      least = std::min(least, apart.norm() - 2 * kRadius);
    }
    EXPECT_GT(least, -1e-6) << mirrored;
    EXPECT_GT(side * stateOf(world, "second").twist.v_WB.x(), 4.0)
        << "0.95 of 0.95 of 6 m/s, less friction: " << mirrored;
  }
}

// A ball strikes another one that turns on the spot without friction, past the budget: the turn of a ball is nothing that it feels.
TEST(ImpactBudget, WhatIsStruckMayTurn) {
  constexpr double kRadius = 0.2;
  std::vector<Vec3> velocities;
  for (const double spin : {0.0, 60.0, -150.0}) {
    SceneDef scene = plankOnBalls();
    for (int k = 0; k < 12; ++k) {
      scene.bodies.push_back(landing("a" + std::to_string(k), 2.0 + 0.4 * k, 0.001 * k));
      scene.bodies.back().material.restitution = 0.9;
    }
    BodyDef target = ball("target", kRadius, {0.0, 0.0, kTop + kRadius});
    target.twist.w_WB.z() = spin;
    BodyDef strikes =
        ball("strikes", kRadius, {-(2 * kRadius + 2.9 * kStep * 6.0), 0.0, kTop + kRadius + 0.02});
    strikes.twist.v_WB.x() = 6.0;
    for (BodyDef* of : {&target, &strikes})
      of->material.restitution = 0.9, of->material.friction = 0.0, scene.bodies.push_back(*of);
    World world(scene);
    for (int k = 0; k < 5; ++k) world.step();
    velocities.push_back(stateOf(world, "target").twist.v_WB);
  }
  EXPECT_GT(velocities.front().x(), 5.0);
  for (const Vec3& v_W : velocities) EXPECT_LT((v_W - velocities.front()).norm(), 1e-6);
}

// Smooth balls that touch come down on a tilted floor and rebound, more often than the budget allows to cut the step for.
TEST(ImpactBudget, ReboundsInAHeapGainNoEnergy) {
  constexpr double kRadius = 0.15, kTilt = 0.02;
  SceneDef scene = onFloor(kStep, 0.0);
  scene.fidelity = Fidelity::Accurate;
  scene.bodies.front().pose.q_WB = Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitY()));
  for (int k = 0; k < 7 * 7 * 5; ++k) {
    const Vec3 at(k % 7 - 3, k / 7 % 7 - 3, k / 49);
    scene.bodies.push_back(ball("b" + std::to_string(k), kRadius, 2 * kRadius * at + Vec3(0.0, 0.0, 0.3)));
    scene.bodies.back().twist.v_WB.z() = -1.0;
  }
  for (BodyDef& of : scene.bodies) of.material.restitution = 0.9, of.material.friction = 0.0;
  World world(scene);
  double before = world.totals().kinetic_energy + world.totals().potential_energy;
  for (int k = 0; k < 15; ++k) {
    world.step();
    const double kinetic = world.totals().kinetic_energy, now = kinetic + world.totals().potential_energy;
    EXPECT_LT(now - before, 1e-4 * kinetic) << "step " << k;
    before = now;
  }
}

// 160 balls of several sizes that rain into a pen, three times. The first cuts of a heap that many bodies strike tell little of the
// others, and what they cost is missing where the forces of the step are looked for: then soft contacts took over, what had rebounded
// went into its neighbours, and the overlaps cut the steps that followed.
TEST(ImpactBudget, AHeapOfReboundingBallsIsMostlySolved) {
  constexpr int kBalls = 160, kSide = 4;
  constexpr double kApart = 0.8, kWidth = kApart * kSide;
  int unsolved = 0;
  double deepest = 0.0;
  for (const double phase : {0.0, 0.5, 1.0}) {
    SceneDef scene = onFloor(kStep, 0.5);
    scene.fidelity = Fidelity::Accurate;
    for (int k = 0; k < 4; ++k) {
      const double side = k % 2 ? -1.0 : 1.0, at = side * (kWidth / 2 + 0.1);
      BodyDef wall = k < 2 ? body("wall" + std::to_string(k), Box{{0.2, kWidth + 0.4, 2.0}}, {at, 0.0, 1.0})
                           : body("wall" + std::to_string(k), Box{{kWidth + 0.4, 0.2, 2.0}}, {0.0, at, 1.0});
      wall.kind = BodyKind::Static;
      scene.bodies.push_back(wall);
    }
    for (int k = 0; k < kBalls; ++k) {
      const double off = 0.05 * std::sin(7.3 * k + phase), middle = 0.5 * (kSide - 1);
      const Vec3 at(kApart * (k % kSide - middle) + off, kApart * (k / kSide % kSide - middle) - off,
                    0.7 + kApart * (k / (kSide * kSide)));
      scene.bodies.push_back(ball("b" + std::to_string(k), 0.21 + 0.075 * std::sin(3.1 * k), at));
    }
    for (BodyDef& of : scene.bodies) of.material.restitution = 0.3;
    World world(scene);
    for (int k = 0; k < 70; ++k) {
      const StepReport report = world.step();
      deepest = std::max(deepest, report.deepest_penetration);
      for (const IslandResiduals& island : report.residuals) unsolved += !island.converged;
    }
  }
  EXPECT_LT(unsolved, 40) << "53 with 4 cuts for each pair";
  EXPECT_LT(deepest, 0.07) << "0.083 m with them";
}

// What follows behind waits for its impact, where it rebounds: contacts would take the rebound. They stop the first ball before or after
// the second one would meet it.
TEST(ImpactBudget, WhatReboundsBehindABodyThatLandsDoesSo) {
  for (const double speed : {0.1, 0.3, 0.6, 1.0})
    for (int k = 0; k < 14; ++k) {
      const double higher = 0.001 + 0.0015 * (k / 2), gap = k % 2 ? 0.001 : 0.005;
      SceneDef scene = plankOnBalls();
      scene.bodies.push_back(landing("a", 0.0, higher, speed));
      scene.bodies.push_back(landing("b", 0.0, higher + 0.2 + gap, speed));
      scene.bodies.back().material.restitution = 0.9;
      scene.bodies.back().density = 20.0;
      World world(scene);
      double down = 0.0, up = 0.0;
      for (int step = 0; step < 8; ++step) {
        world.step();
        const double v = stateOf(world, "b").twist.v_WB.z();
        down = std::max(down, -v), up = std::max(up, v);
      }
      EXPECT_GT(up, 0.5 * down) << speed << " m/s, " << higher << " m, gap " << gap;
    }
}

}  // namespace
}  // namespace rbs

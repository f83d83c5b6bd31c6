// SPDX-License-Identifier: BSD-3-Clause
// What a step may cost: exact solves of a heap end by count, island by island, and say so.
#include "make_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

namespace rbs::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;

// Boxes, balls, cylinders and cones that come down together.
SceneDef heapOf(int bodies, double step) {
  SceneDef scene = onFloor(step, 0.5);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < bodies; ++k) {
    const double size = 0.2 + 0.3 * unit(random);
    Shape shape = Box{{size, 0.7 * size, 0.5 * size}};
    if (k % 4 == 1) shape = Sphere{0.4 * size};
    if (k % 4 == 2) shape = Cylinder{0.3 * size, size};
    if (k % 4 == 3) shape = Cone{0.4 * size, size};
    const double x = 0.1 * unit(random), y = 0.1 * unit(random);
    scene.bodies.push_back(body("piece_" + std::to_string(k), shape,
                                {0.7 * (k % 3) - 0.7 + x, 0.7 * (k / 3 % 3) - 0.7 + y, 0.5 + 0.6 * (k / 9)}));
    scene.bodies.back().material.friction = 0.5;
    scene.bodies.back().material.restitution = 0.2;
  }
  return scene;
}

int tooDear(const StepReport& report) {
  int times = 0;
  for (const Warning& warning : report.warnings) times += warning.kind == "solve_budget";
  return times;
}

std::uint32_t iterationsOf(const StepReport& report) {
  std::uint32_t iterations = 0;
  for (const IslandResiduals& island : report.residuals) iterations += island.iterations;
  return iterations;
}

// Without the budget the first step takes 45,000 iterations at accurate, and 180,000 at reference.
TEST(SolveBudget, BoundsAStepByCountsAtTheExactSettings) {
  const std::pair<Fidelity, std::uint32_t> kMost[] = {{Fidelity::Accurate, 30000},
                                                      {Fidelity::Reference, 60000}};
  for (const auto& [setting, most] : kMost) {
    SceneDef scene = heapOf(45, 1.0);
    scene.fidelity = setting;
    World world(ordered(scene)), again(ordered(scene));
    int warnings = 0;
    for (int step = 0; step < 4; ++step) {
      bool converged = true;
      const StepReport& report = world.step();
      for (const IslandResiduals& island : report.residuals) converged = converged && island.converged;
      EXPECT_LT(iterationsOf(report), most);
      std::set<std::string> said;
      for (const Warning& warning : report.warnings) {
        EXPECT_TRUE(said.insert(warning.text).second) << "twice: " << warning.text;
        if (warning.kind == "solve_budget")
          EXPECT_THAT(warning.text,
                      AllOf(HasSubstr("body 'piece_"), HasSubstr("bodies)"), HasSubstr("Shorten the step")));
      }
      EXPECT_EQ(converged, said.empty());
      warnings += tooDear(report);
      again.step();
      EXPECT_EQ(world.stateHash(), again.stateHash()) << "counts repeat, unlike times";
    }
    EXPECT_GT(warnings, 0);
  }
}

// What goes beyond the allowances of their bodies is one budget for all heaps of a scene. Four heaps take 60,000 and 55,000
// iterations; four times what one needs would be 228,000 and 459,000.
TEST(SolveBudget, IsSharedByTheIslandsOfAStep) {
  const std::pair<Fidelity, std::uint32_t> kMost[] = {{Fidelity::Accurate, 75000},
                                                      {Fidelity::Reference, 80000}};
  for (const auto& [setting, most] : kMost) {
    SceneDef scene = heapOf(45, 1.0);
    scene.fidelity = setting;
    const std::vector<BodyDef> pieces(scene.bodies.begin() + 1, scene.bodies.end());
    for (int heap = 1; heap < 4; ++heap)
      for (BodyDef piece : pieces) {
        piece.name += "_" + std::to_string(heap);
        piece.pose.p_WB.x() += 100.0 * heap;
        scene.bodies.push_back(piece);
      }
    World world(ordered(scene));
    EXPECT_LT(iterationsOf(world.step()), most) << fidelityName(setting);
  }
}

// What an island needs beyond its own allowance it takes in its turn, also where threads share the islands.
TEST(SolveBudget, IsSpentAlikeByAnyNumberOfThreads) {
  SceneDef scene = heapOf(45, 1.0);
  scene.fidelity = Fidelity::Accurate;
  scene.effects[Effect::Restitution] = false;
  const std::vector<BodyDef> pieces(scene.bodies.begin() + 1, scene.bodies.end());
  for (BodyDef piece : pieces) {
    piece.name += "_beside";
    piece.pose.p_WB.x() += 100.0;
    scene.bodies.push_back(piece);
  }
  World one(ordered(scene)), many(ordered(scene));
  many.setThreads(3);
  int warnings = 0;
  for (int step = 0; step < 4; ++step) {
    const StepReport& report = one.step();
    warnings += tooDear(report);
    const StepReport& other = many.step();
    EXPECT_EQ(tooDear(report), tooDear(other));
    EXPECT_EQ(iterationsOf(report), iterationsOf(other));
    EXPECT_EQ(one.stateHash(), many.stateHash()) << "after step " << step + 1;
  }
  EXPECT_GT(warnings, 0);
}

TEST(SolveBudget, LeavesOtherIslandsExact) {
  SceneDef beside = onFloor(1.0, 0.5);
  beside.fidelity = Fidelity::Reference;
  for (int k = 0; k < 3; ++k) {
    beside.bodies.push_back(box("brick_" + std::to_string(k), {1.0, 1.0, 0.5}, {100.0, 0.0, 0.25 + 0.5 * k}));
    beside.bodies.back().twist.v_WB.x() = 8.0;  // no forces of the last step solve what slides
  }
  SceneDef both = heapOf(45, 1.0);
  both.fidelity = Fidelity::Reference;
  both.bodies.insert(both.bodies.end(), beside.bodies.begin() + 1, beside.bodies.end());
  World alone(ordered(beside)), world(ordered(both));
  int warnings = 0;
  for (int step = 0; step < 3; ++step) {
    alone.step();
    const StepReport& report = world.step();
    warnings += tooDear(report);
    EXPECT_THAT(report.residuals, Contains(AllOf(Field(&IslandResiduals::bodies, 3u),
                                                 Field(&IslandResiduals::converged, true))));
    for (int k = 0; k < 3; ++k) {
      const std::string name = "brick_" + std::to_string(k);
      EXPECT_LT((alone.pose(alone.find(name)).p_WB - world.pose(world.find(name)).p_WB).norm(), 1e-12)
          << name;
    }
  }
  EXPECT_GT(warnings, 0);
}

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// What a step allocates goes with the number of bodies: an island's share does not grow with the bodies of
// others.
#include "make_scene.h"
#include "rigid_body_sim/simulator.h"

#include <gtest/gtest.h>

#include <malloc.h>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> allocated{0};  // bytes, so far
std::atomic<std::size_t> live{0};       // bytes, now
}  // namespace

void* operator new(std::size_t size) {
  allocated += size;
  void* memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  live += malloc_usable_size(memory);
  return memory;
}
void operator delete(void* memory) noexcept {
  live -= malloc_usable_size(memory);
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}

namespace rbs::test {
namespace {

// So many separate stacks of two boxes.
SceneDef stacksOf(int stacks, Fidelity fidelity, double spin) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  for (int k = 0; k < stacks; ++k)
    for (int level = 0; level < 2; ++level) {
      scene.bodies.push_back(box("box_" + std::to_string(k) + "_" + std::to_string(level),
                                 Vec3(0.4, 0.4, 0.4), Vec3(k % 50, k / 50, 0.2 + 0.4 * level)));
      scene.bodies.back().twist.w_WB.z() = spin;
    }
  scene.fidelity = fidelity;
  return scene;
}

// Bytes that a step allocates.
double bytesAStep(int stacks, Fidelity fidelity, double spin) {
  World world(stacksOf(stacks, fidelity, spin));
  for (int k = 0; k < 3; ++k) world.step();
  const std::size_t before = allocated;
  constexpr int kSteps = 3;
  for (int k = 0; k < kSteps; ++k) world.step();
  return static_cast<double>(allocated - before) / kSteps;
}

class StepMemory : public testing::TestWithParam<std::pair<Fidelity, double>> {};

// Islands that are solved exactly, together, and one by one because their bodies turn fast.
INSTANTIATE_TEST_SUITE_P(Settings, StepMemory,
                         testing::Values(std::pair(Fidelity::Accurate, 0.0),
                                         std::pair(Fidelity::Interactive, 0.0),
                                         std::pair(Fidelity::Interactive, 400.0)));

TEST_P(StepMemory, GoesWithTheNumberOfBodies) {
  const auto [fidelity, spin] = GetParam();
  const double few = bytesAStep(250, fidelity, spin), many = bytesAStep(1000, fidelity, spin);
  EXPECT_LE(many, 4.1 * few) << few << " bytes a step of 250 islands, " << many << " of 1000";
  EXPECT_GE(many, 2.0 * few);
}

TEST(Memory, IsGivenBackWhenAWorldIsCleared) {
  const SceneDef scene = stacksOf(1000, Fidelity::Interactive, 0.0);
  World world(stacksOf(1, Fidelity::Interactive, 0.0));
  world.step();
  world.clear();
  const std::size_t empty = live;
  world.addBodies(scene.bodies);
  for (int k = 0; k < 3; ++k) world.step();
  EXPECT_GT(live, empty + 1000000u);
  world.clear();
  EXPECT_LT(live, empty + 20000u);
}

// The worlds of the history have none of the memory that their steps took.
TEST(Memory, OfStepsIsNotKeptForUndo) {
  SceneDef wall = onFloor(1.0 / 60.0, 0.5);
  for (int row = 0; row < 20; ++row)
    for (int k = 0; k < 20 - row; ++k)
      wall.bodies.push_back(box("box_" + std::to_string(row) + "_" + std::to_string(k), Vec3::Ones(),
                                Vec3(1.1 * (k + 0.5 * row), 0.0, 0.5 + row)));
  Simulator simulator(wall, {true, 1.0});
  simulator.step(3);
  const std::size_t before = live;
  constexpr int kLoads = 5;
  for (int k = 0; k < kLoads; ++k) {
    simulator.load(wall);
    simulator.step(3);
  }
  EXPECT_LT((live - before) / kLoads, 800000u);
}

}  // namespace
}  // namespace rbs::test

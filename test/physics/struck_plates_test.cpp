// SPDX-License-Identifier: BSD-3-Clause
// Stacks of thin plates that heavy balls strike from above, while small bodies come from below: the exact settings solve
// them within their budget, and nothing is pushed into anything.
#include "make_scene.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rbs::test {
namespace {

class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : engine_(seed) {}
  double within(double a, double b) { return std::uniform_real_distribution<>(a, b)(engine_); }
  unsigned upTo(unsigned n) { return engine_() % n; }
  bool oneIn(unsigned n) { return engine_() % n == 0; }

 private:
  std::mt19937 engine_;
};

// One to four plates, one or two balls above them, and up to three bodies below. The seed also chooses the step, gravity,
// the air, friction and the setting.
SceneDef struckPlates(unsigned seed) {
  RandomNumbers random(seed);
  SceneDef scene = emptySpace(std::array{1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0}[seed % 3]);
  if (seed % 2 == 1) scene.gravity = {0.0, 0.0, -kGravity};
  if (seed % 5 == 0) scene.air = Air{};
  scene.fidelity = seed % 4 < 2 ? Fidelity::Accurate : Fidelity::Reference;
  double z = 0.0;
  const unsigned plates = 1 + random.upTo(4);
  for (unsigned k = 0; k < plates; ++k) {
    const double thickness = random.within(0.005, 0.05);
    Shape shape = Cylinder{0.2, 0.5 * thickness};
    if (random.oneIn(3)) {
      std::get<Cylinder>(shape).radius = random.within(0.1, 0.3);
    } else {
      const double length = random.within(0.2, 0.6);
      shape = Box{{length, random.within(0.2, 0.6), thickness}};
    }
    const double x = random.within(-0.02, 0.02), y = random.within(-0.02, 0.02);
    scene.bodies.push_back(body("plate_" + std::to_string(k), shape, {x, y, z + 0.5 * thickness}));
    z += thickness;
  }
  const unsigned above = 1 + random.upTo(2);
  for (unsigned k = 0; k < above; ++k) {
    const double x = random.within(-0.1, 0.1), y = random.within(-0.1, 0.1);
    BodyDef& heavy = scene.bodies.emplace_back(
        ball("heavy_" + std::to_string(k), 0.1, {x, y, z + 0.1 + random.within(1e-3, 0.05) + 0.25 * k}));
    heavy.mass = random.within(5.0, 200.0);
    heavy.twist.v_WB.z() = -random.within(1.0, 10.0);
  }
  const unsigned below = 1 + random.upTo(3);
  for (unsigned k = 0; k < below; ++k) {
    const double size = random.within(0.02, 0.08);
    const Shape shapes[] = {Sphere{size}, Box{{size, size, size}}, Capsule{0.5 * size, size},
                            Cylinder{size, 0.5 * size}};
    const Shape& shape = shapes[random.upTo(4)];
    const double y = random.within(-0.05, 0.05);
    BodyDef& light = scene.bodies.emplace_back(body(
        "light_" + std::to_string(k), shape, {0.18 * k - 0.18, y, -2.0 * size - random.within(1e-3, 0.03)}));
    light.twist.v_WB.z() = random.within(-0.5, 3.0);
    for (double& w : light.twist.w_WB) w = random.within(-3.0, 3.0);
    light.material.restitution = 0.5 * random.upTo(3);
  }
  for (BodyDef& def : scene.bodies) def.material.friction = 0.3 * (seed % 3);
  return scene;
}

// The deepest overlap, as a share of the smaller of the two smallest extents.
double deepestOverlap(const World& world) {
  const Snapshot snapshot = world.snapshot();
  const auto& bodies = *snapshot.bodies;
  double deepest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double distance =
          gap(bodies[i].shape, snapshot.states[i].pose, bodies[j].shape, snapshot.states[j].pose).distance;
      deepest = std::max(deepest, -distance / std::min(fullExtents(bodies[i].shape).minCoeff(),
                                                       fullExtents(bodies[j].shape).minCoeff()));
    }
  return deepest;
}

// Found among the first 150: overlaps of up to 0.6 once. Budgets had gone into digits that rounding makes up, into segments
// that were halved over a point of a rim that the narrow phase had not shown, and into steps that began again and again.
TEST(StruckPlates, AreNotPushedIntoEachOther) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<> off(-1e-13, 1e-13);
  for (const unsigned seed : {2, 3, 11, 13, 30, 45, 49, 85, 87, 91, 114, 121, 123, 126, 136})
    for (int start = 0; start < 2; ++start) {
      SceneDef scene = struckPlates(seed);
      if (start > 0)
        for (BodyDef& def : scene.bodies) def.pose.p_WB += Vec3(off(engine), off(engine), off(engine));
      for (const SceneDef& ordered : inBothOrders(scene)) {
        World world(ordered);
        for (int step = 0; step < 4; ++step) {
          const StepReport& report = world.step();
          EXPECT_LE(report.repeated, 2 * scene.bodies.size()) << "seed " << seed;
          const bool solved = std::all_of(report.residuals.begin(), report.residuals.end(),
                                          [](const IslandResiduals& island) { return island.converged; });
          EXPECT_LE(deepestOverlap(world), solved ? 1e-4 : 1e-3)
              << "seed " << seed << ", start " << start << ", step " << step;
        }
      }
    }
}

}  // namespace
}  // namespace rbs::test

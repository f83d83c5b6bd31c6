// SPDX-License-Identifier: BSD-3-Clause
// A scene that moves at a constant velocity as a whole goes on as one at rest (Galilei).
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace rbs::test {
namespace {

// A body with a spin that falls on a slab, which moves and turns in two of three scenes.
SceneDef onSlab(unsigned seed, Fidelity fidelity, double step) {
  const std::vector<Shape> shapes{Box{{0.3, 0.4, 0.5}}, Capsule{0.1, 0.2}, Cylinder{0.2, 0.15},
                                  Cone{0.2, 0.4},       Sphere{0.2},       Box{{0.5, 0.5, 0.05}}};
  std::mt19937_64 random(seed);
  const auto draw = [&](double most) { return most * (std::ldexp(random() >> 11, -52) - 1.0); };
  const auto vector = [&](double most) {
    const double x = draw(most), y = draw(most);
    return Vec3(x, y, draw(most));
  };
  SceneDef scene;
  scene.step = step;
  scene.fidelity = fidelity;
  BodyDef slab = box("slab", {6.0, 6.0, 1.0}, {0.3, -0.2, -0.5});
  slab.kind = BodyKind::Kinematic;
  slab.material.friction = std::vector<double>{0.0, 0.3, 1.0}[random() % 3];
  slab.material.restitution = random() % 3 == 0 ? 0.5 : 0.0;
  if (seed % 3 > 0)
    slab.twist = {vector(1.0).cwiseProduct(Vec3(1.0, 1.0, 0.3)),
                  vector(1.0).cwiseProduct(Vec3(0.3, 0.3, 3.0))};
  BodyDef def = body("body", shapes[seed % shapes.size()], {0.0, 0.0, 0.55});
  const Vec3 axis = vector(1.0);
  def.pose.q_WB = Quat(draw(1.0), axis.x(), axis.y(), axis.z()).normalized();
  def.twist = {vector(2.0), vector(6.0)};
  def.material = slab.material;
  scene.bodies = {slab, def};
  return scene;
}

// What rounding turns over is no matter of the frame: a body that begins 1e-10 m beside it goes on otherwise too. A threshold that is
// just reached in one frame and not in the other is left in 7 of 200 at `preview`, 9 at `interactive`. Before, 40 and 41 went on
// otherwise, and 8 and 9 at the exact settings: the warm start of the soft step and the work of a kinematic body that turns were
// judged from the ground.
TEST(MovingFrame, AVelocityOfAllBodiesChangesNothing) {
  constexpr unsigned kSeeds = 100;
  constexpr double kOff = 5e-5, kChaos = 1e-6;  // m
  for (const Fidelity fidelity : kFidelities) {
    int others = 0, compared = 0;
    for (unsigned seed = 0; seed < kSeeds; ++seed)
      for (const double step : {1.0 / 30.0, 1.0 / 60.0}) {
        const SceneDef scene = ordered(onSlab(seed, fidelity, step));
        std::mt19937 random(seed);
        const auto draw = [&] { return 6.0 * (random() / 2147483648.0 - 1.0); };
        const double x = draw(), y = draw();
        const Vec3 frame_W(x, y, draw());
        SceneDef moving = scene, aside = scene;
        for (BodyDef& def : moving.bodies) def.twist.v_WB += frame_W;
        for (BodyDef& def : aside.bodies)
          if (def.name == "body") def.pose.p_WB += Vec3(1e-10, -1e-10, 1e-10);
        World at_rest(scene), moved(moving), beside(aside);
        const auto positionIn = [](const World& world) { return stateOf(world, "body").pose.p_WB; };
        bool parts = false;
        while (at_rest.time() < 1.0 && !parts) {
          for (World* world : {&at_rest, &moved, &beside}) world->step();
          const Vec3 p_W = positionIn(at_rest);
          if ((positionIn(beside) - p_W).norm() > kChaos) break;
          parts = (positionIn(moved) - at_rest.time() * frame_W - p_W).norm() > kOff;
        }
        others += parts;
        compared += parts || at_rest.time() >= 1.0;
      }
    EXPECT_LE(others, fidelity >= Fidelity::Accurate ? 1 : 12) << fidelityName(fidelity);
    EXPECT_GE(compared, 100) << fidelityName(fidelity) << ": the others go on otherwise by themselves";
  }
}

}  // namespace
}  // namespace rbs::test

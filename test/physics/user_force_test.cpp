// SPDX-License-Identifier: BSD-3-Clause
// A body that a mouse holds: it comes to hang at rest, whatever it is, and at every setting and step.
#include "make_scene.h"

#include "rigid_body_sim/polyhedron.h"
#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

struct Held {
  const char* name;
  Shape shape;
  Vec3 p_B;  ///< where it is held, m
};

std::vector<Held> heldBodies() {
  const std::vector<Vec3> wedge = {{0, 0, 0}, {0.6, 0, 0}, {0, 0.4, 0}, {0, 0, 0.3}, {0.5, 0.3, 0.1}};
  const ConvexHull hull = makeHull(wedge, "wedge").hull;
  return {{"ball", Sphere{0.25}, {0.25, 0.0, 0.0}},
          {"box by a corner", Box{{0.5, 0.5, 0.5}}, {0.25, 0.25, 0.25}},
          {"box by the middle of a side", Box{{0.5, 0.5, 0.5}}, {0.25, 0.0, 0.0}},
          {"plank by a corner", Box{{0.6, 0.3, 0.05}}, {0.3, 0.15, 0.025}},
          {"needle by an end", Box{{0.5, 0.01, 0.01}}, {0.25, 0.0, 0.0}},
          {"needle by its middle", Box{{0.5, 0.01, 0.01}}, {0.0, 0.002, 0.0}},
          {"hull by a corner", hull, hull.polyhedron->vertices.front()},
          {"crumb by a corner", Box{{0.01, 0.01, 0.01}}, {0.005, 0.005, 0.005}}};
}

/// A body without others, that turns and is held still by a point from now on.
World held(const Held& what, double step, Fidelity fidelity, double gravity = kGravity) {
  SceneDef scene = emptySpace(step);
  scene.gravity = {0.0, 0.0, -gravity};
  scene.fidelity = fidelity;
  scene.bodies.push_back(body("body", what.shape, Vec3::Zero()));
  scene.bodies.back().twist.w_WB = {3.0, 2.0, 4.0};
  World world(scene);
  Grab grab;
  grab.p_B = grab.p_W = what.p_B;
  world.grab(world.find("body"), grab);
  return world;
}

class UserForce : public ::testing::TestWithParam<Fidelity> {};

TEST_P(UserForce, AHeldBodyHangsAtRest) {
  for (const double step : {1.0 / 30.0, 1.0 / 60.0, 1.0 / 480.0}) {
    for (const Held& what : heldBodies()) {
      World world = held(what, step, GetParam());
      advance(world, 1.0);
      EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 0.65) << what.name << ", step " << step;
      advance(world, 0.5);
      EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 0.2) << what.name << ", step " << step;
      advance(world, 6.0);
      const BodyState state = stateOf(world, "body");
      if (what.p_B.norm() < 0.01 * boundingRadius(what.shape))
        continue;  // nearly balanced: it hangs at its leisure
      EXPECT_LE(state.twist.w_WB.norm(), 2e-3) << what.name << ", step " << step;
      EXPECT_LE(state.twist.v_WB.norm(), 2e-3) << what.name << ", step " << step;
      const Vec3 down_W = -(state.pose.q_WB * what.p_B).normalized();
      EXPECT_LE(down_W.z(), -0.999) << what.name << " hangs by the point, step " << step;
    }
  }
}

// A body of ten metres swings slowly, and comes to hang as slowly; it never swings up again.
TEST_P(UserForce, AHugeBodyHangsAtRestInItsOwnTime) {
  World world = held({"block", Box{{10.0, 8.0, 6.0}}, {5.0, 4.0, 3.0}}, 1.0 / 60.0, GetParam());
  advance(world, 10.0);
  EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 0.02);
}

TEST_P(UserForce, WithoutGravityItStopsTurning) {
  for (const Held& what : heldBodies()) {
    World world = held(what, 1.0 / 60.0, GetParam(), 0.0);
    advance(world, 2.0);
    EXPECT_LE(stateOf(world, "body").twist.w_WB.norm(), 1e-2) << what.name;
  }
}

// What damps cannot drive: the energy of turning never grows where nothing else acts, however fast it turns.
TEST_P(UserForce, ItNeverSpinsABodyUp) {
  for (const double speed : {1.0, 1e3}) {
    for (const Held& what : heldBodies()) {
      World world = held(what, 1.0 / 60.0, GetParam(), 0.0);
      BodyEdit edit;
      edit.twist = Twist{Vec3::Zero(), speed * Vec3(0.1, 1.0, 0.3)};
      world.editBody(world.find("body"), edit);
      double before = world.totals().kinetic_energy;
      const double first = before;
      for (int k = 0; k < 120; ++k) {
        world.step();
        const double now = world.totals().kinetic_energy;
        EXPECT_LE(now, before + 0.02 * first) << what.name << ", step " << k;
        before = now;
      }
      EXPECT_LE(before, 1e-3 * first) << what.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, UserForce, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return fidelityName(info.param); });

}  // namespace

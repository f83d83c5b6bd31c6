// SPDX-License-Identifier: BSD-3-Clause
// Two kinematic fingers close on a body, lift it and hold it. Rigid bodies leave the force between them open
// (solver/exact_squeeze.cpp); what they hold must not fall all the same.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rbs::test {
namespace {

constexpr double kGap = 0.005;  // between a finger and the body at first, m

struct Held {
  std::string name;
  Shape shape;
  double width, height, mass;  // m, m, kg
};

std::vector<Held> held() {
  return {{"box", Box{Vec3::Constant(0.05)}, 0.05, 0.05, 0.1},
          {"heavy box", Box{Vec3::Constant(0.05)}, 0.05, 0.05, 5.0},
          {"ball", Sphere{0.025}, 0.05, 0.05, 0.1},
          {"cylinder", Cylinder{0.025, 0.04}, 0.05, 0.08, 0.2},
          {"slender box", Box{{0.02, 0.02, 0.2}}, 0.02, 0.2, 0.1}};
}

// Fingers that may close on a body on the floor.
class Gripper {
 public:
  Gripper(const Held& what, Fidelity fidelity, double step, double friction)
      : world_(sceneOf(what, fidelity, step, friction)) {}

  // Moves the fingers towards each other by `way` each, and up by `up`.
  void move(double way, double up, double seconds) {
    const double speed = way / seconds;
    const auto steps = std::lround(seconds / world_.scene().step);
    setVelocity("left", {speed, 0.0, up / seconds});
    setVelocity("right", {-speed, 0.0, up / seconds});
    warnings_ = 0;
    for (long k = 0; k < steps; ++k) warnings_ += world_.step().warnings.empty() ? 0 : 1;
    setVelocity("left", Vec3::Zero());
    setVelocity("right", Vec3::Zero());
  }
  // Of the body above the fingers, m.
  double above() const {
    return stateOf(world_, "body").pose.p_WB.z() - stateOf(world_, "left").pose.p_WB.z();
  }
  Vec3 place() const { return stateOf(world_, "body").pose.p_WB; }
  int warnings() const { return warnings_; }  // steps with one, of the last move

 private:
  static SceneDef sceneOf(const Held& what, Fidelity fidelity, double step, double friction) {
    SceneDef scene = onFloor(step, friction);
    scene.fidelity = fidelity;
    BodyDef body = test::body("body", what.shape, {0.0, 0.0, 0.5 * what.height});
    body.mass = what.mass;
    scene.bodies.push_back(body);
    for (const double side : {-1.0, 1.0}) {
      BodyDef finger = box(side < 0.0 ? "left" : "right", {0.02, 0.04, 0.04},
                           {side * (0.5 * what.width + kGap + 0.01), 0.0, 0.5 * what.height});
      finger.kind = BodyKind::Kinematic;
      scene.bodies.push_back(finger);
    }
    for (BodyDef& def : scene.bodies) def.material.friction = friction;
    return ordered(scene);
  }
  void setVelocity(const std::string& name, const Vec3& v_W) {
    BodyEdit edit;
    edit.twist = Twist{v_W, Vec3::Zero()};
    world_.editBody(world_.find(name), edit);
  }

  World world_;
  int warnings_ = 0;
};

// Before, the exact settings let everything fall, and `interactive` what is slender.
TEST(Grip, WhatTwoFingersHoldIsLiftedAndStaysWhereItIs) {
  for (const Held& what : held())
    for (const Fidelity fidelity : {Fidelity::Interactive, Fidelity::Accurate, Fidelity::Reference})
      for (const double step : {1.0 / 60.0, 1.0 / 240.0})
        for (const double overlap : {1e-4, 1e-3}) {
          const std::string where = what.name + " at " + fidelityName(fidelity) + ", " +
                                    std::to_string(1.0 / step) + " Hz, overlap " + std::to_string(overlap);
          Gripper gripper(what, fidelity, step, 0.8);
          gripper.move(kGap + overlap, 0.0, 0.25);
          gripper.move(0.0, 0.0, 0.1);
          const double before = gripper.above();
          gripper.move(0.0, 0.03, 0.6);
          const double lifted = gripper.above();
          EXPECT_NEAR(lifted, before, fidelity == Fidelity::Interactive ? 1e-2 : 1e-3) << where;
          gripper.move(0.0, 0.0, 1.0);
          if (fidelity == Fidelity::Interactive) continue;
          EXPECT_NEAR(gripper.above(), lifted, 1e-6) << where;
          EXPECT_EQ(gripper.warnings(), 0) << where;
        }
}

TEST(Grip, WithoutFrictionItFallsFreely) {
  for (const Held& what : held())
    for (const Fidelity fidelity : {Fidelity::Accurate, Fidelity::Reference}) {
      Gripper gripper(what, fidelity, 1.0 / 240.0, 0.0);
      gripper.move(kGap + 1e-4, 0.0, 0.25);
      gripper.move(0.0, 0.03, 0.6);
      EXPECT_NEAR(gripper.place().z(), 0.5 * what.height, 1e-6)
          << what.name << " at " << fidelityName(fidelity);
    }
}

TEST(Grip, ClosingFingersAreReportedToLeaveNoRoom) {
  for (const Held& what : held())
    for (const Fidelity fidelity : {Fidelity::Accurate, Fidelity::Reference}) {
      Gripper gripper(what, fidelity, 1.0 / 240.0, 0.8);
      gripper.move(kGap + 5e-4, 0.0, 0.25);
      EXPECT_GT(gripper.warnings(), 3) << what.name << " at " << fidelityName(fidelity);
      gripper.move(-kGap, 0.0, 0.25);
      gripper.move(0.0, 0.0, 1.0);
      EXPECT_LT(gripper.place().norm(), 1.5 * what.height) << what.name << " at " << fidelityName(fidelity);
    }
}

}  // namespace
}  // namespace rbs::test

// Rolling and torsional resistance, against closed forms.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr double kRadius = 0.1;

// By how much a soft contact lets the ball sink in, as a share of its radius: the lever arm of its friction is
// shorter by that. g/w² with w = 0.3 pi over a sub-step.
double sagOf(Fidelity fidelity) {
  const double w = 0.3 * kPi * 60.0 * (fidelity == Fidelity::Preview ? 1 : 8);
  return kGravity / (w * w) / kRadius;
}

SceneDef marble(Fidelity fidelity, double rolling, double torsional) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = fidelity;
  scene.bodies.push_back(ball("marble", kRadius, {0.0, 0.0, kRadius}));
  scene.bodies.back().material.rolling_resistance = rolling;
  scene.bodies.back().material.torsional_resistance = torsional;
  return scene;
}

class Rolling : public ::testing::TestWithParam<Fidelity> {};

// It rolls with a = -(5/7) c g and stops after v²/(2 a), for good.
TEST_P(Rolling, AMarbleComesToRestWhereItShould) {
  const double c = 0.02, v = 0.5, a = 5.0 / 7.0 * c * kGravity;
  SceneDef scene = marble(GetParam(), c, 0.0);
  scene.bodies.back().twist = {{v, 0.0, 0.0}, {0.0, v / kRadius, 0.0}};
  World world(scene);
  for (int k = 0; k < 60 * 3; ++k) {
    world.step();
    const double t = world.time();
    const double speed = stateOf(world, "marble").twist.v_WB.x();
    EXPECT_NEAR(speed, std::max(v - a * t, 0.0), (0.002 + sagOf(GetParam())) * v) << t;
    EXPECT_NEAR(stateOf(world, "marble").twist.w_WB.y() * kRadius, speed, (0.002 + 2.0 * sagOf(GetParam())) * v) << t;
  }
  advance(world, v / a - 3.0 + 0.1);
  EXPECT_LE(stateOf(world, "marble").twist.v_WB.norm(), 1e-6);
  EXPECT_NEAR(stateOf(world, "marble").pose.p_WB.x(), v * v / (2.0 * a), (0.005 + sagOf(GetParam())) * v * v / (2.0 * a));
}

TEST_P(Rolling, AMarbleStaysOnASlopeUpToItsResistance) {
  const double c = 0.05;
  const double near = 0.02 + sagOf(GetParam());
  for (const double share : {1.0 - near, 1.0 + near}) {
    SceneDef scene = marble(GetParam(), c, 0.0);
    scene.gravity = slopeGravity(std::atan(share * c));
    World world(scene);
    advance(world, 1.5);
    const double x = stateOf(world, "marble").pose.p_WB.x();
    advance(world, 0.5);
    const double rolled = 0.5 * 5.0 / 7.0 * kGravity * 4.0 * (share - 1.0) * c;
    if (share < 1.0) {
      EXPECT_LE(std::abs(x), 0.3 * sagOf(GetParam()) * kRadius);  // until the contact carries it
      EXPECT_LE(std::abs(stateOf(world, "marble").pose.p_WB.x() - x), 1e-6 * kRadius);
    } else {
      EXPECT_NEAR(stateOf(world, "marble").pose.p_WB.x(), rolled, (0.05 + 2.0 * sagOf(GetParam()) / near) * rolled);
    }
  }
}

// It spins down with -(5/2) s g/R.
TEST_P(Rolling, ASpinningMarbleStopsAtTheRightInstant) {
  const double s = 0.01, w = 5.0;
  SceneDef scene = marble(GetParam(), 0.0, s);
  scene.bodies.back().twist.w_WB = {0.0, 0.0, w};
  World world(scene);
  const double rate = 2.5 * s * kGravity / kRadius;
  while (world.time() < w / rate + 0.2) {
    world.step();
    EXPECT_NEAR(stateOf(world, "marble").twist.w_WB.z(), std::max(w - rate * world.time(), 0.0), 0.002 * w);
  }
  EXPECT_LE(stateOf(world, "marble").twist.w_WB.norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Settings, Rolling, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return std::string(fidelityName(info.param)); });

// 1/R = 1/R_a + 1/R_b and c_a + c_b: a ball in the middle of a larger static one's top is slowed by the smaller
// lever arm. A box has no radius and feels nothing.
TEST(RollingPairs, ABoxFeelsNoRollingResistance) {
  const auto slide = [](double resistance) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.3);
    scene.bodies.push_back(box("box", {0.2, 0.2, 0.2}, {0.0, 0.0, 0.1}));
    scene.bodies.back().twist.v_WB.x() = 2.0;
    scene.bodies.back().material.rolling_resistance = resistance;
    scene.bodies.back().material.torsional_resistance = resistance;
    World world(scene);
    advance(world, 1.0);
    return stateOf(world, "box");
  };
  EXPECT_EQ(slide(0.0).pose.p_WB, slide(0.1).pose.p_WB);
}

TEST(RollingPairs, TheResistancesOfTheTwoAddUp) {
  const auto run = [](double of_ball, double of_floor) {
    SceneDef scene = marble(Fidelity::Interactive, of_ball, 0.0);
    scene.bodies.front().material.rolling_resistance = of_floor;
    scene.bodies.back().twist = {{0.5, 0.0, 0.0}, {0.0, 0.5 / kRadius, 0.0}};
    World world(scene);
    advance(world, 1.0);
    return stateOf(world, "marble").pose.p_WB;
  };
  EXPECT_EQ(run(0.02, 0.0), run(0.0, 0.02));
  EXPECT_NEAR(run(0.01, 0.01).x(), run(0.02, 0.0).x(), 1e-15);
  EXPECT_GT(run(0.01, 0.0).x(), run(0.02, 0.0).x() + 0.01);
}

}  // namespace

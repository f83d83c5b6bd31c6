// SPDX-License-Identifier: BSD-3-Clause
// The normal of a surface of revolution goes through its axis. So without friction nothing changes the spin of a body of
// revolution about its axis, and nothing turns a ball.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

class AxisSpin : public testing::TestWithParam<Fidelity> {
 protected:
  double within(double a, double b) { return std::uniform_real_distribution<>(a, b)(random_); }
  Vec3 anyIn(double most) { return {within(-most, most), within(-most, most), within(-most, most)}; }
  bool isExact() const { return GetParam() == Fidelity::Accurate || GetParam() == Fidelity::Reference; }

  // A body that falls somehow.
  BodyDef thrown(const std::string& name, const Shape& shape, const Vec3& p_W) {
    BodyDef def = body(name, shape, p_W);
    def.material.friction = 0.0;
    def.pose.q_WB = rotationBy(anyIn(2.0));
    def.twist.v_WB = Vec3(within(-2.0, 2.0), within(-2.0, 2.0), within(-2.0, 0.0));
    return def;
  }

 private:
  std::mt19937_64 random_{7};
};
INSTANTIATE_TEST_SUITE_P(Settings, AxisSpin, testing::ValuesIn(kFidelities),
                         [](const auto& at) { return fidelityName(at.param); });

double axisSpin(const World& world) {
  const BodyState state = stateOf(world, "body");
  return (state.pose.q_WB * Vec3::UnitZ()).dot(state.twist.w_WB);
}

TEST_P(AxisSpin, StaysOnAPlaneWithoutFriction) {
  const double most = isExact() ? 2e-3 : 0.05;  // rad/s
  for (int k = 0; k < 90; ++k) {
    // The fourth part of the cylinders has three equal moments of inertia.
    const double radius = within(0.1, 0.3), any = within(0.04, 0.6);
    const double length = k % 12 == 0 ? std::sqrt(3.0) * radius : any;
    const std::array<Shape, 3> shapes{Cylinder{radius, 0.5 * length}, Capsule{radius, 0.5 * length},
                                      Cone{radius, length}};
    SceneDef scene = onFloor(1.0 / 240.0, 0.0);
    scene.fidelity = GetParam();
    scene.bodies.push_back(thrown("body", shapes[k % 3], {0.0, 0.0, 0.6}));
    scene.bodies.back().twist.w_WB = anyIn(5.0);
    World world(ordered(scene));
    const double before = axisSpin(world);
    for (int step = 0; step < 240; ++step) {
      world.step();
      ASSERT_NEAR(axisSpin(world), before, most) << k << ", step " << step;
    }
  }
}

TEST_P(AxisSpin, OfABallStaysZeroAmongOthersWithoutFriction) {
  for (int k = 0; k < 40; ++k) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.0);
    scene.fidelity = GetParam();
    scene.effects[Effect::Rotation] = true;
    for (int n = 0; n < 5; ++n) {
      const std::array<Shape, 4> shapes{Sphere{within(0.1, 0.3)},
                                        Cylinder{within(0.1, 0.25), within(0.05, 0.25)},
                                        Capsule{within(0.1, 0.2), within(0.1, 0.2)},
                                        Box{{within(0.2, 0.5), within(0.2, 0.5), within(0.2, 0.5)}}};
      const bool is_ball = n % 2 == 0;
      const Vec3 p_W(0.65 * (n % 2), 0.65 * (n / 2 % 2), 0.5 + 0.7 * (n / 4));
      scene.bodies.push_back(thrown((is_ball ? "ball_" : "other_") + std::to_string(n),
                                    shapes[is_ball ? 0 : 1 + (k + n) % 3], p_W));
      if (!is_ball) scene.bodies.back().twist.w_WB = anyIn(5.0);
    }
    World world(ordered(scene));
    for (int step = 0; step < 60; ++step) {
      world.step();
      for (const char* name : {"ball_0", "ball_2", "ball_4"})
        ASSERT_LE(stateOf(world, name).twist.w_WB.norm(), 1e-10) << k << ", step " << step;
    }
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Nothing gains energy from contacts alone. Two bodies of random shapes fall onto the floor, one on the other, and slide
// and roll off each other: contact points run along rims and edges faster than the step resolves at its full length.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

namespace rbs::test {
namespace {

// The most that a step may gain, as a share of the kinetic energy and of that of a fall for one step.
constexpr double kMost = 1e-3;

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  double size() { return 0.1 * std::pow(5.0, between(0.0, 1.0)); }  // m
  double normal() { return normal_(random_); }
  Vec3 vector() { return Vec3{normal(), normal(), normal()}; }
  Quat orientation() {
    const Eigen::Vector4d q{normal(), normal(), normal(), normal()};
    return Quat(q).normalized();
  }
  Shape shape() {
    const double a = size(), b = size(), c = size();
    switch (random_() % 5) {
      case 0:
        return Sphere{a};
      case 1:
        return Box{2.0 * Vec3(a, b, c)};
      case 2:
        return Cylinder{a, b};
      case 3:
        return Capsule{a, b};
      default:
        return Cone{a, 2.0 * b};
    }
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<> normal_;
};

SceneDef twoThatFall(unsigned seed, Fidelity fidelity, double step, double friction) {
  Dice dice(seed);
  SceneDef scene = onFloor(step, friction);
  scene.fidelity = fidelity;
  for (const double height : {1.0, 2.2}) {
    const Shape shape = dice.shape();
    const Vec3 p_WB{dice.between(-0.2, 0.2), dice.between(-0.2, 0.2), height};
    BodyDef body = test::body("body_" + std::to_string(scene.bodies.size()), shape, p_WB);
    body.pose.q_WB = dice.orientation();
    body.twist.w_WB = 3.0 * dice.vector();
    body.mass = std::exp(dice.between(-1.0, 1.0));
    body.material.friction = friction;
    scene.bodies.push_back(body);
  }
  return scene;
}

// The largest gain of a step in a run of 2 s, as a share.
double largestGain(const SceneDef& scene) {
  World world(ordered(scene));
  double mass = 0.0, largest = 0.0;
  for (const BodyDef& body : scene.bodies)
    if (body.kind == BodyKind::Dynamic) mass += *body.mass;
  const double fall = 0.5 * mass * kGravity * kGravity * scene.step * scene.step;
  for (double time = 0.0; time < 2.0; time += scene.step) {
    const Totals before = world.totals();
    world.step();
    const Totals after = world.totals();
    const double gain =
        after.kinetic_energy + after.potential_energy - before.kinetic_energy - before.potential_energy;
    largest = std::max(largest, gain / (before.kinetic_energy + fall));
  }
  return largest;
}

using Setting = std::tuple<Fidelity, double, double>;  // and step, s; friction
class EnergyGain : public testing::TestWithParam<Setting> {};

TEST_P(EnergyGain, OfContactsIsNone) {
  const auto [fidelity, step, friction] = GetParam();
  for (unsigned seed = 0; seed < 50; ++seed)
    EXPECT_LE(largestGain(twoThatFall(seed, fidelity, step, friction)), kMost) << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(Settings, EnergyGain,
                         testing::Combine(testing::Values(Fidelity::Accurate, Fidelity::Reference),
                                          testing::Values(1.0 / 60.0, 1.0 / 240.0),
                                          testing::Values(0.0, 0.4)));

}  // namespace
}  // namespace rbs::test

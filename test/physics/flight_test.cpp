// Bodies that nothing touches, against closed forms, whatever the step.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

class Flight : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, Flight, testing::Values(1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0));

TEST_P(Flight, AProjectileFollowsTheParabolaToRounding) {
  SceneDef scene;
  scene.step = GetParam();
  scene.bodies.push_back(ball("shot", 0.5, Vec3(1.0, 2.0, 3.0)));
  scene.bodies.back().twist.v_WB = {10.0, 5.0, 20.0};
  World world(scene);
  advance(world, 10.0);
  const double t = world.time();
  const Vec3 expected =
      Vec3(1.0, 2.0, 3.0) + t * Vec3(10.0, 5.0, 20.0) + 0.5 * t * t * Vec3(0.0, 0.0, -kGravity);
  EXPECT_LE((stateOf(world, "shot").pose.p_WB - expected).norm(), 1e-12 * expected.norm());
  EXPECT_NEAR(stateOf(world, "shot").twist.v_WB.z(), 20.0 - kGravity * t, 1e-11);
}

// m v' = m g - k v², k = rho c A/2, from rest: v = vt tanh(g t/vt), vt = sqrt(m g/k).
TEST_P(Flight, AFallingBallReachesItsTerminalVelocityAsTheHyperbolicTangent) {
  SceneDef scene;
  scene.step = GetParam();
  scene.air = Air{};
  scene.bodies.push_back(ball("ball", 0.2, Vec3(0.0, 0.0, 0.0)));
  scene.bodies.back().mass = 0.5;
  World world(scene);
  const double terminal = std::sqrt(0.5 * kGravity / (0.5 * 1.2 * kRoundedDrag * kPi * 0.2 * 0.2));
  for (const double seconds : {0.5, 1.5, 8.0}) {
    advance(world, seconds);
    const double expected = terminal * std::tanh(kGravity * world.time() / terminal);
    EXPECT_NEAR(-stateOf(world, "ball").twist.v_WB.z(), expected, 0.5 * GetParam() * expected)
        << world.time();
  }
  advance(world, 30.0);
  EXPECT_NEAR(-stateOf(world, "ball").twist.v_WB.z(), terminal, 1e-6 * terminal);
}

TEST_P(Flight, AFeatherInAStormTakesTheSpeedOfTheWindAndNotMore) {
  SceneDef scene = emptySpace(GetParam());
  scene.air = Air{};
  scene.wind = Wind{{50.0, 0.0, 0.0}, 0.0};
  scene.bodies.push_back(ball("feather", 0.5, Vec3::Zero()));
  scene.bodies.back().mass = 1e-4;
  scene.bodies.push_back(box("leaf", Vec3(1.0, 1.0, 0.01), Vec3(0.0, 10.0, 0.0)));
  scene.bodies.back().mass = 1e-4;
  World world(scene);
  double before = 0.0;
  for (int k = 0; k < 200; ++k) {
    world.step();
    const double speed = stateOf(world, "feather").twist.v_WB.x();
    EXPECT_GE(speed, before * (1.0 - 1e-12));
    EXPECT_LE(speed, 50.0 * (1.0 + 1e-12));
    EXPECT_LE(stateOf(world, "leaf").twist.v_WB.x(), 50.0 * (1.0 + 1e-9));
    before = speed;
  }
  EXPECT_GT(before, 45.0);
}

// A symmetric top without torque: with moments I1 = I2 and I3 the axis turns about L at |L|/I1, and the body
// turns about its own axis against that at (I1 - I3)/I1 w3.
TEST_P(Flight, ASymmetricTopPrecessesAboutItsAngularMomentum) {
  SceneDef scene = emptySpace(GetParam());
  scene.bodies.push_back(box("top", Vec3(0.2, 0.2, 0.6), Vec3::Zero()));
  scene.bodies.back().mass = 1.0;
  scene.bodies.back().twist.w_WB = {1.0, 0.0, 10.0};
  World world(scene);
  const double I1 = (0.2 * 0.2 + 0.6 * 0.6) / 12.0, I3 = 2.0 * 0.2 * 0.2 / 12.0;
  const Vec3 L(I1 * 1.0, 0.0, I3 * 10.0);
  advance(world, 10.0);
  const double t = world.time();
  const Quat about_L(Eigen::AngleAxisd(L.norm() / I1 * t, L.normalized()));
  const Quat about_axis(Eigen::AngleAxisd((I1 - I3) / I1 * 10.0 * t, Vec3::UnitZ()));
  const Quat expected = about_L * about_axis;
  EXPECT_LE(expected.angularDistance(stateOf(world, "top").pose.q_WB), 1e-3);
  EXPECT_LE((world.totals().angular_momentum - L).norm(), 1e-13 * L.norm());
}

// The intermediate axis theorem: the body flips, and keeps its energy and its angular momentum.
TEST_P(Flight, AnUnstableSpinFlipsAndKeepsEnergyAndAngularMomentum) {
  SceneDef scene = emptySpace(GetParam());
  scene.bodies.push_back(box("racket", Vec3(0.2, 0.4, 0.6), Vec3::Zero()));
  scene.bodies.back().twist.w_WB = {0.01, 10.0, 0.01};
  World world(scene);
  const Totals before = world.totals();
  int flips = 0;
  bool up = true;
  for (double t = 0.0; t < 20.0; t = world.time()) {
    world.step();
    const BodyState racket = stateOf(world, "racket");
    const double along = (racket.pose.q_WB.conjugate() * racket.twist.w_WB).y();
    if (std::abs(along) > 8.0 && (along > 0.0) != up) up = !up, ++flips;
  }
  EXPECT_EQ(flips, 6);  // the flips are 3.514 s apart, from elliptic integrals; the sixth ends at 19.10 s
  const Totals after = world.totals();
  EXPECT_NEAR(after.kinetic_energy / before.kinetic_energy, 1.0, 1e-9);
  EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(),
            1e-13 * before.angular_momentum.norm());
}

}  // namespace

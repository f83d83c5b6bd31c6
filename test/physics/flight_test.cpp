// SPDX-License-Identifier: BSD-3-Clause
// Bodies that nothing touches, against closed forms, whatever the step.
#include "free_top_oracle.h"
#include "make_scene.h"
#include "random_draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace rbs;
using namespace rbs::test;
using namespace rbs::oracle;

namespace {

class Flight : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, Flight, testing::Values(1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0));

TEST_P(Flight, AProjectileFollowsTheParabolaToRounding) {
  SceneDef scene;
  scene.step = GetParam();
  scene.bodies.push_back(ball("shot", 0.5, Vec3(1.0, 2.0, 3.0)));
  scene.bodies.back().twist.v_WB = {10.0, 5.0, 20.0};
  World world(ordered(scene));
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
  World world(ordered(scene));
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
  World world(ordered(scene));
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

// By the attitude and the spin at the start of a step it was off by 0.024 at 1/60 s and 0.006 at 1/240 s.
TEST(FlightInAir, ABoxThatTumblesIsWhereShortStepsSay) {
  const auto placeAfterASecond = [](const Vec3& w_WB, int steps) {
    SceneDef scene;
    scene.step = 1.0 / steps;
    scene.air = Air{};
    scene.bodies.push_back(box("card", Vec3(0.4, 0.2, 0.05), Vec3::Zero()));
    scene.bodies.back().density = 50.0;
    scene.bodies.back().twist = {{2.0, 3.0, 1.0}, w_WB};
    World world(ordered(scene));
    for (int k = 0; k < steps; ++k) world.step();
    return stateOf(world, "card").pose;
  };
  for (const Vec3& w_WB : {Vec3(1.0, 3.0, 5.0), Vec3(3.0, 0.0, 5.0), Vec3(-4.0, 2.0, 0.5)}) {
    const Pose exact = placeAfterASecond(w_WB, 7680);
    const auto error = [&](int steps) {
      const Pose pose = placeAfterASecond(w_WB, steps);
      return std::max((pose.p_WB - exact.p_WB).norm(), pose.q_WB.angularDistance(exact.q_WB));
    };
    EXPECT_LT(error(60), 2e-3) << w_WB.transpose();
    EXPECT_LT(error(240), 2e-4) << w_WB.transpose();
  }
}

// Still air takes energy away from what flies through it and turns in it, however fast: 300 needles and plates that turn by up to
// 100 rad in a step. Before, their air was that of one attitude for all of the step, and one gained 70 % in ten steps.
TEST(FlightInAir, StillAirNeverAddsEnergy) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomDraws draws(seed);
    SceneDef scene;
    scene.gravity.setZero();
    scene.step = 1.0 / draws.between(30.0, 240.0);
    scene.air = Air{std::pow(10.0, draws.between(-2.0, 3.0))};
    const double length = std::pow(10.0, draws.between(-1.5, 0.0)), thin = draws.between(0.04, 0.08);
    const double flat = seed % 2 == 0 ? thin : draws.between(0.04, 1.0);
    scene.bodies.push_back(box("body", length * Vec3(1.0, thin, flat), Vec3::Zero()));
    scene.bodies.back().density = std::pow(10.0, draws.between(1.0, 3.0));
    scene.bodies.back().pose.q_WB = rotationBy(draws.vector(3.0));
    scene.bodies.back().twist.v_WB = draws.vector(std::pow(10.0, draws.between(-1.0, 2.0)));
    scene.bodies.back().twist.w_WB = draws.vector(std::pow(10.0, draws.between(0.0, 3.5)));
    World world(ordered(scene));
    double before = world.snapshot().totals.kinetic_energy;
    const double start = before;
    for (int k = 0; k < 100; ++k) {
      world.step();
      const double now = world.snapshot().totals.kinetic_energy;
      ASSERT_LE(now, before + 1e-9 * start) << "seed " << seed << ", step " << k;
      before = now;
    }
  }
}

// A symmetric top without torque: with moments I1 = I2 and I3 the axis turns about L at |L|/I1, and the body
// turns about its own axis against that at (I1 - I3)/I1 w3.
TEST_P(Flight, ASymmetricTopPrecessesAboutItsAngularMomentum) {
  SceneDef scene = emptySpace(GetParam());
  scene.bodies.push_back(box("top", Vec3(0.2, 0.2, 0.6), Vec3::Zero()));
  scene.bodies.back().mass = 1.0;
  scene.bodies.back().twist.w_WB = {1.0, 0.0, 10.0};
  World world(ordered(scene));
  const double I1 = (0.2 * 0.2 + 0.6 * 0.6) / 12.0, I3 = 2.0 * 0.2 * 0.2 / 12.0;
  const Vec3 L(I1 * 1.0, 0.0, I3 * 10.0);
  advance(world, 100.0);
  const double t = world.time();
  const Quat about_L(Eigen::AngleAxisd(L.norm() / I1 * t, L.normalized()));
  const Quat about_axis(Eigen::AngleAxisd((I1 - I3) / I1 * 10.0 * t, Vec3::UnitZ()));
  const Quat expected = about_L * about_axis;
  EXPECT_LE(angleBetween(expected, stateOf(world, "top").pose.q_WB), 1e-10);
  EXPECT_LE((world.totals().angular_momentum - L).norm(), 1e-12 * L.norm());
}

struct Tumble {
  const char* name;
  Vec3 size, w;  // of a box of 1 kg
  double seconds, orientation;
};

TEST_P(Flight, ATumblingBoxTurnsAsEulersEquationsSay) {
  for (const Tumble& c :
       {Tumble{"slow tumble", Vec3(0.2, 0.4, 0.6), Vec3(1.0, 2.0, 3.0), 5.0, 5e-12},
        Tumble{"violent tumble", Vec3(0.2, 0.4, 0.6), Vec3(10.0, 20.0, 30.0), 10.0, 2e-10},
        Tumble{"needle", Vec3(2.0, 0.02, 0.02), Vec3(200.0, 1.0, 0.5), 2.0, 1e-10},
        Tumble{"needle end over end", Vec3(2.0, 0.02, 0.02), Vec3(1.0, 200.0, 0.5), 2.0, 1e-8}}) {
    SceneDef scene = emptySpace(GetParam());
    scene.bodies.push_back(box("box", c.size, Vec3::Zero()));
    scene.bodies.back().mass = 1.0;
    scene.bodies.back().twist.w_WB = c.w;
    World world(ordered(scene));
    const Totals before = world.totals();
    advance(world, c.seconds);
    const double t = world.time();
    const Vec3 moments = (c.size.squaredNorm() * Vec3::Ones() - Vec3(c.size.cwiseProduct(c.size))) / 12.0;
    EXPECT_LE(angleBetween(orientationOf(integrated(moments.cwiseProduct(c.w), moments, t)),
                           stateOf(world, "box").pose.q_WB),
              c.orientation)
        << c.name;
    const Totals after = world.totals();
    EXPECT_NEAR(after.kinetic_energy / before.kinetic_energy, 1.0, 1e-11) << c.name;
    EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(),
              1e-11 * before.angular_momentum.norm())
        << c.name;
  }
}

TEST_P(Flight, ASpinAboutAPrincipalAxisKeepsItsPhase) {
  for (const int axis : {0, 2}) {  // about the middle one rounding grows e-fold every 2 ms
    SceneDef scene = emptySpace(GetParam());
    scene.bodies.push_back(box("box", Vec3(0.2, 0.4, 0.6), Vec3::Zero()));
    scene.bodies.back().twist.w_WB = 1000.0 * Vec3::Unit(axis);
    World world(ordered(scene));
    advance(world, 100.0);
    const double t = world.time();
    const Quat expected(Eigen::AngleAxisd(std::remainder(1000.0 * t, 2.0 * kPi), Vec3::Unit(axis)));
    EXPECT_LE(angleBetween(expected, stateOf(world, "box").pose.q_WB), 1e-9) << axis;
  }
}

// The intermediate axis theorem: the body flips, and keeps its energy and its angular momentum. With
// l_2 = A_2 sn(u_0 - rate t) the middle axis lies across L at rate t - u_0 = 0, 2 K(k), 4 K(k), ...; K and
// u_0 are Legendre's integrals, from the standard library, in long double.
TEST_P(Flight, AnUnstableSpinFlipsInTimeAndKeepsEnergyAndAngularMomentum) {
  SceneDef scene = emptySpace(GetParam());
  scene.bodies.push_back(box("racket", Vec3(0.2, 0.4, 0.6), Vec3::Zero()));
  scene.bodies.back().mass = 1.0;
  scene.bodies.back().twist.w_WB = {0.01, 10.0, 0.01};
  World world(ordered(scene));
  const Totals before = world.totals();

  // Moments fall from x to z. About x or z, whichever the polhode encircles.
  const long double I1 = 0.52L / 12, I2 = 0.40L / 12,
                    I3 = 0.20L / 12;  // 0.4² + 0.6², 0.2² + 0.6², 0.2² + 0.4²
  const long double l1 = I1 * 0.01L, l2 = I2 * 10.0L, l3 = I3 * 0.01L;
  const long double c1 = 1 / I2 - 1 / I1, c3 = 1 / I3 - 1 / I2, c = c1 + c3;
  const bool about_x = c1 * l1 * l1 > c3 * l3 * l3;
  const long double cp = about_x ? c1 : c3, co = about_x ? c3 : c1, lp = about_x ? l1 : l3,
                    lo = about_x ? l3 : l1;
  const long double Ap = std::sqrt(lp * lp + co / c * l2 * l2), Ao = std::sqrt(lo * lo + cp / c * l2 * l2),
                    A2 = std::sqrt(l2 * l2 + c / cp * lo * lo);
  const long double k = std::sqrt(co / cp) * Ao / Ap, rate = Ap * std::sqrt(c * cp);
  const long double K = std::comp_ellint_1(k);
  // dl_2/dt = (1/I1 - 1/I3) l_3 l_1 < 0: the phase falls from its start, where sn and cn are positive.
  const long double start = std::ellint_1(k, std::asin(l2 / A2));

  std::vector<double> flips;
  const auto along = [&] {
    const BodyState racket = stateOf(world, "racket");
    return (racket.pose.q_WB.conjugate() * racket.twist.w_WB).y();
  };
  for (double last = along(); flips.size() < 6 && world.time() < 25.0;) {
    world.step();
    const double now = along();
    if ((now > 0.0) != (last > 0.0)) flips.push_back(world.time() - GetParam() * now / (now - last));
    last = now;
  }
  ASSERT_EQ(flips.size(), 6u);
  for (int n = 0; n < 6; ++n)
    EXPECT_NEAR(flips[static_cast<std::size_t>(n)], static_cast<double>((start + 2 * n * K) / rate), 1e-4)
        << n;

  const Totals after = world.totals();
  EXPECT_NEAR(after.kinetic_energy / before.kinetic_energy, 1.0, 1e-12);
  EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(),
            1e-13 * before.angular_momentum.norm());
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Impacts against closed forms, whatever the step.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

class Impact : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, Impact, testing::Values(1.0 / 60.0, 1.0 / 240.0, 1.0 / 1000.0));

// A ball let fall over a gap comes to the floor at t0 = sqrt(2 gap/g) with v0 = g t0, and after bounce k
// flies for 2 e^k t0, e^(2k) gap high.
TEST_P(Impact, ABallBouncesAtTheTimesAndToTheHeightsOfTheClosedForm) {
  for (const double e : {0.5, 0.9, 0.99, 1.0}) {
    SceneDef scene = onFloor(GetParam(), 0.6);
    scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 1.5)));
    scene.bodies.back().material.restitution = e;
    World world(ordered(scene));
    const double t0 = std::sqrt(2.0 / kGravity);
    const auto height = [&](double t) {  // of the gap
      if (t < t0) return 1.0 - 0.5 * kGravity * t * t;
      double start = t0, speed = kGravity * t0 * e;
      while (t > start + 2.0 * speed / kGravity) start += 2.0 * speed / kGravity, speed *= e;
      return (t - start) * (speed - 0.5 * kGravity * (t - start));
    };
    // Up to the bounce whose flight is ten steps long; the last ones are the contact solver's.
    double until = 5.0;
    if (e < 1.0) {
      double start = t0, flight = 2.0 * e * t0;
      while (flight > 10.0 * GetParam() && start < until) start += flight, flight *= e;
      until = std::min(until, start);
    }
    while (world.time() + GetParam() < until) {
      world.step();
      EXPECT_NEAR(stateOf(world, "ball").pose.p_WB.z() - 0.5, height(world.time()), 1e-10)
          << "e " << e << ", t " << world.time();
    }
  }
}

TEST_P(Impact, ABouncingBallComesToRestAndStaysThere) {
  for (const double e : {0.0, 0.1, 0.5, 0.9}) {
    SceneDef scene = onFloor(GetParam(), 0.6);
    scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 1.5)));
    scene.bodies.back().material.restitution = e;
    World world(ordered(scene));
    advance(world, 12.0);  // the last bounce with e = 0.9 ends at 8.6 s
    const BodyState early = stateOf(world, "ball");
    EXPECT_NEAR(early.pose.p_WB.z(), 0.5, 1e-3) << e;
    advance(world, 2.0);
    EXPECT_LE((stateOf(world, "ball").pose.p_WB - early.pose.p_WB).norm(), 1e-9) << e;
    EXPECT_LE(stateOf(world, "ball").twist.v_WB.norm(), 1e-9) << e;
    EXPECT_EQ(world.step().impacts, 0u);
  }
}

// With n from 1 to 2, the point's velocity u = v2 - v1 + (w2 r2 + w1 r1) x -n has the normal part u_n, which
// takes J = -(1+e) m u_n with 1/m = 1/m1 + 1/m2, and a tangential part, on which the pair answers with a
// response of 7/2 that of its centres: it takes 2/7 m |u_t| to stop it, or mu J if that is less.
TEST_P(Impact, TwoSpheresCollideObliquelyWithFrictionAndSpin) {
  for (const double e : {0.0, 0.5, 1.0}) {
    for (const double mu : {0.0, 0.3}) {
      for (const double offset : {0.0, 0.4, 0.9, 1.1}) {
        const double r1 = 0.5, r2 = 0.7, m1 = 1.0, m2 = 3.0;
        SceneDef scene = emptySpace(GetParam());
        scene.bodies.push_back(ball("one", r1, Vec3::Zero()));
        scene.bodies.push_back(ball("two", r2, Vec3(1.5, offset, 0.0)));
        for (BodyDef& def : scene.bodies) def.material.friction = mu, def.material.restitution = e;
        scene.bodies[0].mass = m1, scene.bodies[1].mass = m2;
        const Vec3 v1(3.0, 0.0, 0.2), w1(0.0, 4.0, 5.0), v2(-1.0, 0.0, 0.0), w2(2.0, 0.0, -1.0);
        scene.bodies[0].twist = {v1, w1}, scene.bodies[1].twist = {v2, w2};
        World world(ordered(scene));
        const Totals before = world.totals();
        advance(world, 0.4);

        const Vec3 d(1.5, offset, 0.0), v = v2 - v1;
        const double b = d.dot(v), c = d.squaredNorm() - (r1 + r2) * (r1 + r2);
        const double t = c / (-b + std::sqrt(b * b - v.squaredNorm() * c));
        const Vec3 n = (d + t * v).normalized();
        const Vec3 u = v2 - v1 - (r2 * w2 + r1 * w1).cross(n);
        const double m = m1 * m2 / (m1 + m2), u_n = n.dot(u), J = -(1.0 + e) * m * u_n;
        const Vec3 u_t = u - u_n * n;
        const double stop = 2.0 / 7.0 * m * u_t.norm();
        const Vec3 friction = -u_t * (stop <= mu * J ? 2.0 / 7.0 * m : mu * J / u_t.norm());
        const Vec3 P = J * n + friction;
        const Vec3 w1_after = w1 - (r1 * n).cross(P) / (0.4 * m1 * r1 * r1);
        const Vec3 w2_after = w2 + (-r2 * n).cross(P) / (0.4 * m2 * r2 * r2);

        const std::string which =
            "e " + std::to_string(e) + " mu " + std::to_string(mu) + " b " + std::to_string(offset);
        EXPECT_LE((stateOf(world, "one").twist.v_WB - (v1 - P / m1)).norm(), 1e-12) << which;
        EXPECT_LE((stateOf(world, "two").twist.v_WB - (v2 + P / m2)).norm(), 1e-12) << which;
        EXPECT_LE((stateOf(world, "one").twist.w_WB - w1_after).norm(), 1e-12) << which;
        EXPECT_LE((stateOf(world, "two").twist.w_WB - w2_after).norm(), 1e-12) << which;
        EXPECT_LE((world.totals().momentum - before.momentum).norm(), 1e-14 * 10.0);
        EXPECT_LE((world.totals().angular_momentum - before.angular_momentum).norm(), 1e-13 * 10.0);
      }
    }
  }
}

std::vector<double> cradle(double step, const std::vector<double>& speeds, double gap) {
  SceneDef scene = emptySpace(step);
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    scene.bodies.push_back(
        ball("ball_" + std::to_string(k), 0.5, Vec3(k * (1.0 + gap) + (k >= 1 ? 0.1 : 0.0), 0.0, 0.0)));
    scene.bodies.back().material.restitution = 1.0;
    scene.bodies.back().twist.v_WB.x() = speeds[k];
  }
  World world(ordered(scene));
  advance(world, 1.0);
  std::vector<double> after;
  for (std::size_t k = 0; k < speeds.size(); ++k)
    after.push_back(stateOf(world, "ball_" + std::to_string(k)).twist.v_WB.x());
  return after;
}

TEST_P(Impact, InACradleAsManyBallsLeaveAsCame) {
  for (const double gap : {0.0, 1e-9, 1e-3}) {
    const std::vector<double> one = cradle(GetParam(), {1.0, 0.0, 0.0, 0.0, 0.0}, gap);
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(one[k], k == 4 ? 1.0 : 0.0, 1e-12) << gap;
    // Two come: the first pushes the second, which hits first.
    const std::vector<double> two = cradle(GetParam(), {1.0, 1.0, 0.0, 0.0, 0.0}, gap);
    EXPECT_NEAR(two[0] + two[1] + two[2] + two[3] + two[4], 2.0, 1e-12);
  }
}

// G. Galperin, "Playing pool with pi", 2003: a ball of mass 1 between a wall and one of mass 100^k that comes
// meets wall and ball as often as the first k + 1 digits of pi say. All is along z, so that nothing is
// rounded sideways: spheres in line are unstable.
TEST_P(Impact, ABilliardCountsTheDigitsOfPi) {
  const unsigned digits[] = {3, 31, 314, 3141, 31415};
  for (int k = 0; k < 5; ++k) {
    SceneDef scene = emptySpace(GetParam());
    scene.bodies = {floorOf(0.0), ball("light", 0.5, Vec3(0.0, 0.0, 2.0)),
                    ball("heavy", 0.5, Vec3(0.0, 0.0, 4.0))};
    for (BodyDef& def : scene.bodies) def.material.restitution = 1.0, def.material.friction = 0.0;
    scene.bodies[1].mass = 1.0;
    scene.bodies[2].mass = std::pow(100.0, k);
    scene.bodies[2].twist.v_WB.z() = -1.0;
    World world(ordered(scene));
    const double before = energy(world);
    unsigned count = 0;
    for (int step = 0; step < 12.0 / GetParam(); ++step) count += world.step().impacts;
    EXPECT_EQ(count, digits[k]);
    EXPECT_NEAR(energy(world) / before, 1.0, 1e-11);
  }
}

TEST_P(Impact, ABoxThatFallsFlatLeavesFlatAtItsRestitution) {
  SceneDef scene = onFloor(GetParam(), 0.6);
  scene.bodies.push_back(box("box", Vec3(1.0, 0.6, 0.4), Vec3(0.3, -0.2, 1.2)));
  scene.bodies.back().material.restitution = 0.5;
  World world(ordered(scene));
  const double arrival = std::sqrt(2.0 / kGravity), after = 0.1;
  while (world.time() < arrival + after) world.step();
  const Twist twist = stateOf(world, "box").twist;
  EXPECT_NEAR(twist.v_WB.z(), 0.5 * kGravity * arrival - kGravity * (world.time() - arrival), 1e-10);
  EXPECT_LE(twist.v_WB.head<2>().norm(), 1e-12);
  EXPECT_LE(twist.w_WB.norm(), 1e-12);
}

// A thin rod at angle th to the floor, without friction: J = (1+e) v/(1/m + (l cos th)²/I), at half length l.
TEST_P(Impact, ARodThatFallsOnItsEdgeTurnsAsItsLeverSays) {
  const double th = 0.5, e = 0.5;
  SceneDef scene = onFloor(GetParam(), 0.0);
  BodyDef rod = box("rod", Vec3(2.0, 0.1, 0.1), Vec3(0.0, 0.0, 2.0));
  rod.pose.q_WB = Quat(Eigen::AngleAxisd(th, Vec3::UnitY()));
  rod.mass = 1.0;
  rod.material.restitution = e;
  scene.bodies.push_back(rod);
  World world(ordered(scene));
  while (world.step().impacts == 0) ASSERT_LT(world.time(), 2.0);
  // The lowest edge is at (1, -0.05) in the rod's x and z.
  const double lever = std::cos(th) * 1.0 - std::sin(th) * 0.05;
  const double reach = std::sin(th) * 1.0 + std::cos(th) * 0.05;
  const double v = std::sqrt(2.0 * kGravity * (2.0 - reach));
  const double I = (2.0 * 2.0 + 0.1 * 0.1) / 12.0;
  const double J = (1.0 + e) * v / (1.0 + lever * lever / I);
  EXPECT_NEAR(std::abs(stateOf(world, "rod").twist.w_WB.y()), J * lever / I, 1e-10 * J);
}

// Inelastic collapse: balls that lose almost all speed meet without number in a finite time (McNamara and
// Young, "Inelastic collapse and clumping in a one-dimensional granular medium", Phys. Fluids A 4, 1992).
// Each pair meets a few times; then the contact solver has it.
TEST(InelasticCollapse, EndsAfterAFewMeetingsOfEachPair) {
  constexpr int kBalls = 5, kMeetings = 7;
  for (const Fidelity fidelity : kFidelities)
    for (const double restitution : {0.02, 0.05, 0.07}) {
      SceneDef scene = emptySpace(1.0 / 60.0);
      scene.fidelity = fidelity;
      for (int k = 0; k < kBalls; ++k) {
        const int from_middle = k - kBalls / 2;
        scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.1, {0.5 * from_middle, 0.0, 0.0}));
        scene.bodies.back().material.restitution = restitution;
        scene.bodies.back().twist.v_WB.x() = -2.0 * from_middle;
      }
      World world(ordered(scene));
      std::uint32_t most = 0;
      for (int k = 0; k < 30; ++k) most = std::max(most, world.step().impacts);
      EXPECT_LE(most, kMeetings * (kBalls - 1)) << fidelityName(fidelity) << ", e = " << restitution;
      EXPECT_GT(most, 2 * (kBalls - 1));
      EXPECT_NEAR(world.totals().momentum.x(), 0.0, 1e-9);
    }
}

// A box of three different moments that an override keeps from turning: its spin is constant all the same.
TEST_P(Impact, ABodyThatMayNotTurnMeetsTheFloor) {
  for (const Fidelity fidelity : kFidelities)
    for (const double e : {0.0, 0.5}) {
      SceneDef scene = onFloor(GetParam(), 0.6);
      scene.fidelity = fidelity;
      scene.effects[Effect::Rotation] = false;
      scene.bodies.push_back(box("box", {0.2, 0.3, 1.0}, {0.0, 0.0, 1.0}));
      scene.bodies.back().twist = {{0.0, 0.0, -2.0}, {1.0, 2.0, 3.0}};
      scene.bodies.back().material.restitution = e;
      World world(ordered(scene));
      advance(world, 2.0);
      EXPECT_NEAR(stateOf(world, "box").pose.p_WB.z(), 0.5, 2e-3) << fidelityName(fidelity) << ", e " << e;
    }
}

class ImpactAtAnySetting : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, ImpactAtAnySetting, testing::ValuesIn(kFidelities),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

// A body on a floor that comes to another one, or to a wall, just before or after the end of a step.
TEST_P(ImpactAtAnySetting, AtTheEndOfAStepReboundsLikeAnyOther) {
  const double enough = GetParam() < Fidelity::Accurate ? 1e-6 : 1e-9;
  for (const bool round : {true, false})
    for (const bool meets_wall : {true, false})
      for (const auto& [h, v] : {std::pair(1.0 / 60.0, 0.12), {1.0 / 60.0, 12.0}, {1.0 / 30.0, 3.0}})
        for (const double late :
             {-1e-7, -1e-9, -1e-10, -1e-12, 0.0, 1e-12, 1e-10, 1e-9, 1e-8, 5e-8, 9e-8, 1.1e-7, 1e-6, 1e-5}) {
          SceneDef scene = onFloor(h, 0.0);
          scene.fidelity = GetParam();
          const Shape shape = round ? Shape(Sphere{0.5}) : Shape(Box{Vec3::Ones()});
          scene.bodies.push_back(body("comes", shape, {0.0, 0.0, 0.5}));
          scene.bodies.push_back(body("waits", shape, {1.0 + 7.0 * v * h + late, 0.0, 0.5}));
          scene.bodies[1].twist.v_WB.x() = v;
          if (meets_wall) scene.bodies[2].kind = BodyKind::Static;
          for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
          scene.bodies[1].material.restitution = scene.bodies[2].material.restitution = 1.0;
          World world(ordered(scene));
          for (int k = 0; k < 14; ++k) world.step();
          EXPECT_NEAR(stateOf(world, "comes").twist.v_WB.x(), meets_wall ? -v : 0.0, enough * v)
              << (round ? "ball" : "box") << (meets_wall ? " and wall, " : ", ") << v << " m/s, " << late
              << ", " << h << " s";
        }
}

// Nothing drives balls on a floor together: so no rebound is over within a step.
TEST_P(ImpactAtAnySetting, BallsOnAFloorReboundHoweverSlowly) {
  for (const double e : {0.5, 0.9, 1.0})
    for (const double v : {0.01, 0.03, 0.07, 0.09}) {
      SceneDef scene = onFloor(1.0 / 60.0, 0.0);
      scene.fidelity = GetParam();
      scene.bodies.push_back(ball("cue", 0.03, {0.0, 0.0, 0.03}));
      scene.bodies.push_back(ball("object", 0.03, {0.065, 0.0, 0.03}));
      scene.bodies[1].twist.v_WB.x() = v;
      for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
      for (const int k : {1, 2}) scene.bodies[k].material.restitution = e;
      World world(ordered(scene));
      while (world.time() < 0.005 / v + 0.1) world.step();
      EXPECT_NEAR(stateOf(world, "cue").twist.v_WB.x(), 0.5 * (1.0 - e) * v, 1e-6 * v) << e << ", " << v;
      EXPECT_NEAR(stateOf(world, "object").twist.v_WB.x(), 0.5 * (1.0 + e) * v, 1e-6 * v) << e << ", " << v;
      // They meet at 0.005 / v, and not when a sub-step ends.
      const double way = 0.5 * (1.0 + e) * v * (world.time() - 0.005 / v);
      EXPECT_NEAR(stateOf(world, "object").pose.p_WB.x(), 0.065 + way, 1e-6 * way) << e << ", " << v;
    }
}

// A plank that falls on a floor strikes with one end and then with the other. Bodies beside it have nothing to do with that, though
// they may touch it as far as their bounds say.
TEST_P(ImpactAtAnySetting, OfAPlankKeepsItsEnergyBesideWhatItNeverTouches) {
  for (const double h : {1.0 / 30.0, 1.0 / 60.0})
    for (const double tilt : {3.0, 6.0, 12.5})
      for (const double speed : {0.0, 5.0, 20.0}) {
        SceneDef scene = onFloor(h, 0.0);
        scene.fidelity = GetParam();
        scene.bodies.push_back(box("plank", {0.6, 0.1, 0.05}, {0.0, 0.0, 0.5}));
        scene.bodies.back().pose.q_WB = rotationBy(Vec3(0.0, tilt * kPi / 180.0, 0.0));
        scene.bodies.back().material.restitution = 1.0;
        scene.bodies.push_back(box("cube", {0.2, 0.2, 0.2}, {0.0, 0.2, 0.1}));
        for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
        for (const int k : {1, 2}) scene.bodies[k].twist.v_WB.y() = speed;
        World world(ordered(scene));
        const double before = energy(world);
        std::uint32_t impacts = 0;
        for (int k = 0; k * h < 0.5; ++k) impacts += world.step().impacts;
        EXPECT_GE(impacts, 3u) << h << " s, " << tilt << " degrees, " << speed << " m/s";
        // The cube sinks in at the fast settings.
        EXPECT_NEAR(energy(world), before, GetParam() < Fidelity::Accurate ? 0.1 : 1e-6)
            << h << " s, " << tilt << " degrees, " << speed << " m/s";
      }
}

// With u' = -k u^2 a body that meets a wall after t1 comes back, after t2 more, at e v_1/(1 + k e v_1 t2), with
// v_1 = v/(1 + k v t1).
TEST_P(ImpactAtAnySetting, TurnsTheDragRound) {
  const double h = 1.0 / 60.0, side = 0.2, mass = 0.05;
  for (const bool round : {true, false})
    for (const double v : {5.0, 15.0, 40.0})
      for (const double share : {0.05, 0.5, 0.9})
        for (const double e : {1.0, 0.5, 0.0}) {
          SceneDef scene = emptySpace(h);
          scene.fidelity = GetParam();
          scene.air = Air{};
          const double k = 0.5 * scene.air->density / mass *
                           (round ? 0.47 * kPi * 0.25 * side * side : kEdgedDrag * side * side);
          const double t1 = share * h, v1 = v / (1.0 + k * v * t1);
          const double way = std::log1p(k * v * t1) / k;
          scene.bodies.push_back(box("wall", {1.0, 4.0, 4.0}, {0.5 + 0.5 * side + way, 0.0, 0.0}));
          scene.bodies.back().kind = BodyKind::Static;
          const Shape shape = round ? Shape(Sphere{0.5 * side}) : Shape(Box{Vec3::Constant(side)});
          scene.bodies.push_back(body("foam", shape, Vec3::Zero()));
          scene.bodies.back().mass = mass;
          scene.bodies.back().twist.v_WB.x() = v;
          for (BodyDef& def : scene.bodies) def.material.restitution = e, def.material.friction = 0.0;
          World world(ordered(scene));
          world.step();
          // The step of a box in the air is implicit, of second order.
          const double drag = k * v * h, enough = round ? 1e-3 * v : 0.6 * drag * drag * v + 1e-3 * v;
          EXPECT_NEAR(stateOf(world, "foam").twist.v_WB.x(), -e * v1 / (1.0 + k * e * v1 * (h - t1)), enough)
              << (round ? "ball, " : "box, ") << v << " m/s, " << share << " of a step, e " << e;
        }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Motions of bodies in contact with a closed form in textbooks of mechanics: a top on its tip, a block on a wedge that gives
// way, a ball on a plank that it takes along.
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr double kStep = 1.0 / 60.0;

class ClosedForm : public testing::TestWithParam<Fidelity> {
 protected:
  // One of these bounds, by the settings.
  double bound(double preview, double interactive, double exact) const {
    if (GetParam() == Fidelity::Preview) return preview;
    return GetParam() == Fidelity::Interactive ? interactive : exact;
  }
};
INSTANTIATE_TEST_SUITE_P(Settings, ClosedForm, testing::ValuesIn(kFidelities),
                         [](const auto& at) { return fidelityName(at.param); });

BodyDef massive(BodyDef def, double mass, double friction) {
  def.mass = mass;
  def.material.friction = friction;
  def.material.restitution = 0.0;
  return def;
}

// A cone stands on its apex, which friction holds. With the moments I3 about its axis and I1 across it at the apex, the
// distance l from the apex to the centre of mass, the tilt t and the spin s about the axis it precesses steadily at the rates
// W of I1 cos(t) W^2 - I3 s W + g l m = 0; here the slower one (Goldstein, Classical Mechanics, 5.7).
TEST_P(ClosedForm, ATopOnItsTipPrecessesSteadily) {
  const double radius = 0.2, height = 0.2, tilt = 0.7, spin = 60.0, l = 0.75 * height;
  const double i3 = 0.3 * radius * radius, i1 = 0.15 * radius * radius + 0.6 * height * height;  // of 1 kg
  const double half = 0.5 * i3 * spin;
  const double rate = kGravity * l / (half + std::sqrt(half * half - i1 * std::cos(tilt) * kGravity * l));
  const Vec3 axis_W(std::sin(tilt), 0.0, std::cos(tilt));
  BodyDef top = massive(body("top", Cone{radius, height}, l * axis_W), 1.0, 1.0);
  top.pose.q_WB = Quat::FromTwoVectors(-Vec3::UnitZ(), axis_W);
  top.twist.w_WB = rate * Vec3::UnitZ() + (spin - rate * std::cos(tilt)) * axis_W;
  top.twist.v_WB = top.twist.w_WB.cross(l * axis_W);
  SceneDef scene = onFloor(kStep, 1.0);
  scene.fidelity = GetParam();
  scene.bodies.push_back(top);
  World world(ordered(scene));
  for (int k = 1; k <= 120; ++k) {
    world.step();
    const BodyState state = stateOf(world, "top");
    const Vec3 now_W = -(state.pose.q_WB * Vec3::UnitZ());
    const double angle = rate * k * kStep;
    const Vec3 expected_W(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
    ASSERT_LT((now_W - expected_W).norm(), bound(0.1, 0.05, 4e-3)) << "step " << k;
    ASSERT_LT((state.pose.p_WB - l * now_W).norm(), bound(0.08, 0.03, 2e-3)) << "its tip, step " << k;
  }
}

// A block slides down a wedge on a smooth floor. Nothing rubs. The wedge of the angle a and of r times the mass of the block
// has the acceleration g sin(a) cos(a)/(r + sin^2 a) backwards, and the block falls with g (r + 1) sin^2 a/(r + sin^2 a).
TEST_P(ClosedForm, ABlockSlidesDownAWedgeThatGivesWay) {
  for (const auto& [ratio, angle] : {std::pair(1.0, 0.5), std::pair(10.0, 0.9), std::pair(0.1, 0.3)}) {
    const double base = 3.0, height = base * std::tan(angle), size = 0.3, time = 0.4;
    const PlacedHull hull = makeHull({{0.0, -0.5, 0.0},
                                      {base, -0.5, 0.0},
                                      {0.0, -0.5, height},
                                      {0.0, 0.5, 0.0},
                                      {base, 0.5, 0.0},
                                      {0.0, 0.5, height}},
                                     "wedge");
    const Vec3 normal(std::sin(angle), 0.0, std::cos(angle)), down(std::cos(angle), 0.0, -std::sin(angle));
    SceneDef scene = onFloor(kStep, 0.0);
    scene.fidelity = GetParam();
    BodyDef wedge = massive(body("wedge", hull.hull, Vec3::Zero()), ratio, 0.0);
    wedge.pose = hull.X_PB;
    BodyDef block =
        massive(box("block", Vec3::Constant(size), Vec3(0.0, 0.0, height) + 0.5 * down + 0.5 * size * normal),
                1.0, 0.0);
    block.pose.q_WB = Quat::FromTwoVectors(Vec3::UnitZ(), normal);
    scene.bodies.insert(scene.bodies.end(), {wedge, block});
    World world(ordered(scene));
    advance(world, time);
    const double squared = std::sin(angle) * std::sin(angle), common = kGravity / (ratio + squared);
    const double back = common * std::sin(angle) * std::cos(angle) * time,
                 fall = common * (ratio + 1.0) * squared * time;
    const double most = bound(1e-2, 3e-3, 1e-9);  // of the speed
    EXPECT_NEAR(stateOf(world, "wedge").twist.v_WB.x(), -back, most * back) << ratio;
    EXPECT_NEAR(stateOf(world, "block").twist.v_WB.z(), -fall, most * fall) << ratio;
  }
}

// A ball of radius r rolls down a dome of radius R from an angle a, or slides without friction. The dome bears
// N/(m g) = (17 cos t - 10 cos a)/7 of its weight at an angle t, or 3 cos t - 2 cos a (energy, and the force towards the centre).
TEST_P(ClosedForm, ABallOnADomePressesLessAndLess) {
  for (const double step : {1.0 / 240.0, kStep})
    for (const bool rolls : {true, false})
      for (const bool cylinder : {false, true}) {
        SceneDef scene = onFloor(step, 0.0);
        scene.fidelity = GetParam();
        scene.bodies.clear();
        BodyDef dome = body("dome", Sphere{1.0}, Vec3::Zero());
        if (cylinder) dome.shape = Cylinder{1.0, 2.0};
        if (cylinder) dome.pose.q_WB = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitX()));
        dome.kind = BodyKind::Static;
        dome.material.friction = rolls ? 5.0 : 0.0;
        const double start = 0.1;
        const BodyDef ball = body("ball", Sphere{0.1}, 1.1 * Vec3(std::sin(start), 0.0, std::cos(start)));
        scene.bodies = {dome, massive(ball, 1.0, rolls ? 5.0 : 0.0)};
        World world(ordered(scene));
        const auto angle = [&] {
          const Vec3 p_W = world.pose(world.find("ball")).p_WB;
          return std::atan2(p_W.x(), p_W.z());
        };
        double worst = 0.0;
        for (double before = angle(); before < (rolls ? 0.8 : 0.65); before = angle()) {
          world.step();
          const double middle = 0.5 * (before + angle());
          const double force = rolls ? (17.0 * std::cos(middle) - 10.0 * std::cos(start)) / 7.0
                                     : 3.0 * std::cos(middle) - 2.0 * std::cos(start);
          double found = 0.0;
          for (const ContactPoint& point : world.contacts())
            found += point.normal_impulse / (step * kGravity);
          worst = std::max(worst, std::abs(found - force));
          ASSERT_LT(world.time(), 6.0);
        }
        EXPECT_LT(worst, bound(0.2, 0.15, 0.01))
            << step << " s, " << (rolls ? "rolls" : "slides") << (cylinder ? " on a cylinder" : " on a ball");
      }
}

// A ball of the mass m slides onto a plank of the mass M on a smooth floor, until it rolls: friction has then passed on
// J = v/(7/(2 m) + 1/M), for its spin is 5 J/(2 m r).
TEST_P(ClosedForm, ABallTakesAPlankAlong) {
  const double m = 1.0, plank_mass = 2.0, radius = 0.2, v = 2.0;
  SceneDef scene = onFloor(kStep, 0.0);
  scene.fidelity = GetParam();
  BodyDef rolling = massive(ball("ball", radius, {-3.0, 0.0, 0.1 + radius}), m, 0.3);
  rolling.twist.v_WB.x() = v;
  scene.bodies.push_back(massive(box("plank", {10.0, 1.0, 0.1}, {0.0, 0.0, 0.05}), plank_mass, 0.3));
  scene.bodies.push_back(rolling);
  World world(ordered(scene));
  advance(world, 2.0);
  const double passed = v / (3.5 / m + 1.0 / plank_mass), most = bound(2e-3, 5e-4, 1e-10);
  EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), v - passed / m, most);
  EXPECT_NEAR(stateOf(world, "plank").twist.v_WB.x(), passed / plank_mass, most);
  EXPECT_NEAR(stateOf(world, "ball").twist.w_WB.y() * radius, 2.5 * passed / m, most);
}

// What runs over an edge faster than sqrt(g R) leaves it at once, and falls from there on: v_z = -g t. It may cross the edge
// anywhere in a step, also in the first one, of which no force is known; and the table may move. At the fast settings it falls
// from the beginning of the next sub-step on, of which a step has 4 and 8.
TEST_P(ClosedForm, WhatRunsOverAnEdgeFallsFromThereOn) {
  const double R = 0.01, most = bound(0.26, 0.13, 0.03);
  for (const double h : {1.0 / 60.0, 1.0 / 240.0})
    for (const bool is_ball : {true, false})
      for (const double travel : {0.25, 0.7, 1.0, 2.0})  // in a step, over R
        for (const double steps : {0.35, 0.77, 0.97, 1.2, 1.93, 2.45, 3.3})
          for (const double lift : {0.0, 1.0}) {
            const double v = travel * R / h, start = steps * travel;
            if (v < 1.05 * std::sqrt(kGravity * R)) continue;
            SceneDef scene;
            scene.step = h;
            scene.fidelity = GetParam();
            BodyDef table = box("table", {20 * R, 20 * R, 2 * R}, {-10 * R, 0.0, -R});
            table.kind = BodyKind::Kinematic;
            table.twist.v_WB = {0.0, 0.0, lift};
            const Vec3 p_W(-start * R, 0.0, R);
            BodyDef round = is_ball ? ball("round", R, p_W) : body("round", Cylinder{R, R}, p_W);
            if (!is_ball) round.pose.q_WB = rotationBy(Vec3(kPi / 2, 0.0, 0.0));
            round.twist = {Vec3(v, 0.0, lift), Vec3(0.0, v / R, 0.0)};
            scene.bodies = {massive(table, 1.0, 0.3), massive(round, 1.0, 0.3)};
            World world(scene);
            while (world.time() < start * R / v + h) world.step();
            const double falls = kGravity * (world.time() - start * R / v);
            EXPECT_NEAR(world.snapshot().states[1].twist.v_WB.z() - lift, -falls, most * kGravity * h)
                << (is_ball ? "ball" : "cylinder") << ", " << travel << " R a step of " << h << ", from "
                << steps << " steps before the edge, lift " << lift;
          }
}

// However large friction is, what tips over comes to rest flat.
TEST_P(ClosedForm, WhatFrictionTripsComesToRest) {
  for (const double mu : {1.0, 1e3, 1e5, 1e7, 1e9}) {
    SceneDef scene = onFloor(kStep, mu);
    scene.fidelity = GetParam();
    scene.bodies.push_back(massive(box("box", Vec3::Constant(0.2), {0.0, 0.0, 0.1}), 8.0, mu));
    scene.bodies.back().twist.v_WB.x() = 3.0;
    World world(scene);
    advance(world, 4.0);
    const BodyState state = world.snapshot().states[1];
    EXPECT_NEAR(state.pose.p_WB.z(), 0.1, bound(5e-4, 1e-4, 1e-6)) << mu;
    EXPECT_LE(state.twist.w_WB.norm(), 1e-2) << mu;
  }
}

// A ball lands at v and spins about the vertical. The normal impulse is m (1 + e) v, and torsional resistance takes s R of
// it: the spin falls by s R m (1 + e) v/I, with I = 2/5 m R².
TEST_P(ClosedForm, ABallThatLandsLosesSpinToItsResistance) {
  const double R = 0.1, v = 3.0, spin = 50.0, s = 0.02;
  for (const double e : {0.0, 0.5, 1.0})
    for (const double h : {kStep, 1.0 / 1000.0}) {
      SceneDef scene = onFloor(h, 0.5);
      scene.gravity.setZero();
      scene.fidelity = GetParam();
      scene.bodies.push_back(ball("ball", R, {0.0, 0.0, R + 0.031}));
      scene.bodies.back().twist = {Vec3(0.0, 0.0, -v), Vec3(0.0, 0.0, spin)};
      scene.bodies.back().material.restitution = e;
      scene.bodies.back().material.torsional_resistance = s;
      World world(scene);
      advance(world, 0.05);
      EXPECT_NEAR(world.snapshot().states[1].twist.w_WB.z(), spin - s * (1.0 + e) * v / (0.4 * R), 1e-6)
          << e << ", " << h;
    }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Bodies that come down with another edge while one bears: what the law of impact leaves of the energy does not depend on where
// in the step that happens.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace rbs::test {
namespace {

// Quality level, step, s.
class Landing : public ::testing::TestWithParam<std::tuple<Fidelity, double>> {
 protected:
  SceneDef floor(double friction) const {
    SceneDef scene = onFloor(std::get<1>(GetParam()), friction);
    scene.fidelity = std::get<0>(GetParam());
    return scene;
  }
};

// The share of its energy that a rocking block keeps in a landing: G. W. Housner, "The behavior of inverted pendulum structures
// during earthquakes", Bull. Seism. Soc. Am. 53, 1963, with the angle a between its diagonal and its side: angular momentum
// about the edge that comes down is kept, and the other edge leaves.
double keptByBlock(double width, double height) {
  const double sine = width / std::hypot(width, height);
  return std::pow(1.0 - 1.5 * sine * sine, 2);
}

TEST_P(Landing, ABlockRocksByHousnersLaw) {
  for (const double width : {0.2, 0.35}) {
    for (const double tilt : {0.1, 0.13, 0.15, 0.17}) {
      SceneDef scene = floor(1.0);
      const double height = 1.0, radius = 0.5 * std::hypot(width, height), alpha = std::atan2(width, height);
      BodyDef block = box("block", {width, 0.3, height},
                          radius * Vec3(-std::sin(alpha - tilt), 0.0, std::cos(alpha - tilt)));
      block.pose.q_WB = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
      block.mass = 1.0, block.material.friction = 1.0;
      scene.bodies.push_back(block);
      World world(ordered(scene));
      const double level = 0.5 * kGravity * height, first = energy(world) - level;
      const BodyId id = world.find("block");
      double before = first;
      int landings = 0;
      for (double turn_before = 0.0; world.time() < 2.0 && landings < 3;) {
        world.step();
        const double turn = world.pose(id).q_WB.y();
        if (turn * turn_before < 0.0) {
          const double now = energy(world) - level;
          EXPECT_NEAR(now / before, keptByBlock(width, height), 5e-3)
              << "width " << width << ", tilt " << tilt << ", landing " << landings;
          before = now;
          ++landings;
        }
        turn_before = turn;
      }
      EXPECT_GE(landings, 2) << "width " << width << ", tilt " << tilt;
    }
  }
}

// A body that rests beside it, and that it never touches, changes nothing.
TEST_P(Landing, WhatItNeverTouchesChangesNothing) {
  if (std::get<0>(GetParam()) == Fidelity::Interactive) return;  // falls short: docs/stability.md
  for (const double gap : {1e-4, 1e-3, 5e-3}) {
    SceneDef scene = floor(1.0);
    const double tilt = 0.1, radius = 0.5 * std::hypot(0.2, 1.0), alpha = std::atan2(0.2, 1.0);
    BodyDef block =
        box("block", {0.2, 0.3, 1.0}, radius * Vec3(-std::sin(alpha - tilt), 0.0, std::cos(alpha - tilt)));
    block.pose.q_WB = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
    block.material.friction = 1.0;
    scene.bodies.push_back(block);
    World alone(ordered(scene));
    scene.bodies.push_back(box("beside", Vec3::Constant(0.1), {0.0, 0.2 + gap, 0.05}));
    scene.bodies.back().material.friction = 1.0;
    World beside(ordered(scene));
    advance(alone, 1.2), advance(beside, 1.2);
    const BodyState one = stateOf(alone, "block"), other = stateOf(beside, "block");
    EXPECT_LT((one.pose.p_WB - other.pose.p_WB).norm(), 1e-5) << gap;
    EXPECT_LT(stateOf(beside, "beside").twist.v_WB.norm(), 1e-9) << gap;
  }
}

// A prism of n sides that rolls keeps of its energy in each change of edges what is left of its angular momentum about the new
// one, squared: with its inertia k² m and its radius R, ((k² + R² cos(2 pi/n)) / (k² + R²))². A regular polygon
// has k² = R² (2 + cos(2 pi/n)) / 6. It keeps the same where it falls back. In between it loses none.
TEST_P(Landing, APrismRollsOverItsEdges) {
  for (const int sides : {6, 8, 16}) {
    SceneDef scene = floor(1.0);
    const double radius = 0.5, angle = 2.0 * kPi / sides, low = radius * std::cos(0.5 * angle);
    std::vector<Vec3> corners;
    for (int k = 0; k < sides; ++k)
      for (const double y : {-0.25, 0.25})
        corners.emplace_back(radius * std::sin((k + 0.5) * angle), y, -radius * std::cos((k + 0.5) * angle));
    const PlacedHull hull = makeHull(corners, "corners");
    BodyDef prism = body("prism", hull.hull, Vec3::Zero());
    prism.pose = hull.poseOfB({Vec3(0.0, 0.0, low), Quat::Identity()});
    prism.mass = 1.0, prism.material.friction = 1.0;
    const double w =
        3.8;  // about the edge in front, which is the first to bear; with 4 a hexagon leaves the floor
    prism.twist = {{w * low, 0.0, w * radius * std::sin(0.5 * angle)}, {0.0, w, 0.0}};
    scene.bodies.push_back(prism);
    World world(ordered(scene));
    const double square = radius * radius * (2.0 + std::cos(angle)) / 6.0;
    const double kept =
        std::pow((square + radius * radius * std::cos(angle)) / (square + radius * radius), 2);
    const double level = kGravity * low, first = energy(world) - level;
    double changes = 0.0;
    while (world.time() < 1.0 && changes < 8.0) {
      world.step();
      const double now = std::log((energy(world) - level) / first) / std::log(kept);
      EXPECT_NEAR(now, std::round(now), 0.1) << sides << " sides at " << world.time() << " s";
      EXPECT_GE(std::round(now), changes);
      changes = std::round(now);
    }
    EXPECT_GE(changes, 2.0) << sides << " sides";
  }
}

// A box that tumbles comes down with edges of several faces. A large box below it is the same floor as a plane, whichever of the
// two bodies is the older.
TEST(LandingExact, ABoxTumblesOnABoxAsOnAPlane) {
  for (const Fidelity fidelity : {Fidelity::Accurate, Fidelity::Reference}) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
      std::mt19937 random(seed);
      const auto uniform = [&](double from, double to) {
        return from + (to - from) * (random() / 4294967296.0);
      };
      const auto vector = [&](double from, double to) {
        return Vec3(uniform(from, to), uniform(from, to), uniform(from, to));
      };
      BodyDef tumbling = box("box", vector(0.1, 0.5), {0.0, 0.0, uniform(0.3, 0.6)});
      tumbling.pose.q_WB =
          Quat(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)).normalized();
      tumbling.twist = {vector(-0.5, 0.5), vector(-8.0, 8.0)};
      const double step = 1.0 / (10.0 * (1 + seed % 6)), friction = 0.4 * (seed % 3);
      tumbling.material.friction = friction;
      BodyDef slab = box("floor", {6.0, 6.0, 0.2}, {0.0, 0.0, -0.1});
      slab.kind = BodyKind::Static, slab.material.friction = friction;
      SceneDef on_plane = onFloor(step, friction), on_slab = on_plane;
      on_slab.bodies = {slab, tumbling};
      on_plane.bodies.push_back(tumbling);
      std::vector<Twist> ends;
      for (SceneDef scene : {on_plane, on_slab, inBothOrders(on_slab)[1]}) {
        scene.fidelity = fidelity;
        World world(scene);
        advance(world, 0.4);
        ends.push_back(stateOf(world, "box").twist);
      }
      const double fastest = 1.0 + tumbling.twist.w_WB.norm();
      for (const std::size_t k : {1, 2}) {
        EXPECT_LE((ends[k].v_WB - ends[0].v_WB).norm(), 2e-3 * fastest) << "seed " << seed << ", order " << k;
        EXPECT_LE((ends[k].w_WB - ends[0].w_WB).norm(), 2e-3 * fastest) << "seed " << seed << ", order " << k;
      }
    }
  }
}

// A tetrahedron that falls on a floor comes down with several corners in a step. It does not end in the ground, to be lifted
// for nothing by the next step.
TEST(LandingFast, ATetrahedronThatFallsGainsNothing) {
  int gains = 0;
  double worst = 0.0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<> normal;
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    const double a = 0.05;
    const PlacedHull hull = makeHull({{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}}, "tetrahedron");
    BodyDef body = test::body("body", hull.hull, {0.0, 0.0, 0.3 + 0.1 * std::abs(normal(random))});
    body.pose.q_WB = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    body.twist.v_WB.z() = -1.0;
    body.mass = 1.0, body.material.friction = 0.5;
    scene.bodies.push_back(body);
    World world(ordered(scene));
    double most = 0.0, before = energy(world), largest = 0.0;
    while (world.time() < 1.0) {
      world.step();
      largest = std::max(largest, world.totals().kinetic_energy);
      most = std::max(most, energy(world) - before);
      before = energy(world);
    }
    gains += most > 1e-4 * largest;
    worst = std::max(worst, most / largest);
  }
  EXPECT_LE(gains, 8);  // 17 where the step of the impact is soft
  EXPECT_LT(worst, 3e-3);
}

// A plate or a cube without friction that slides in a drum of tiles, and what it has lost to their joints after 1.6 s. A corner
// that closes on the far end of the next tile, and passes it, was stopped as if it came down there: 0.46 and 0.41 m g R lost in
// place of 0.295 and 0.318 with 24 tiles at 1/60 s. What is left are the soft steps of `interactive`, 1e-3.
TEST_P(Landing, NothingIsStoppedByTheTilesOfADrumThatItPasses) {
  constexpr double kRadius = 0.5, kStart = 1.2;  // m, rad
  const auto lost = [&](const Vec3& size, int tiles, Fidelity setting, double step) {
    SceneDef scene = emptySpace(step);
    scene.gravity = -kGravity * Vec3::UnitZ();
    scene.fidelity = setting;
    const double length = 2.0 * (kRadius + 0.2) * std::tan(kPi / tiles);
    for (int k = 0; k < tiles; ++k) {
      const double angle = 2.0 * kPi * k / tiles;
      scene.bodies.push_back(box("tile_" + std::to_string(k), {length, 1.0, 0.2},
                                 (kRadius + 0.1) * Vec3(std::sin(angle), 0.0, -std::cos(angle))));
      scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitY()));
      scene.bodies.back().kind = BodyKind::Static;
    }
    scene.bodies.push_back(
        box("slider", size, (kRadius - 0.065) * Vec3(std::sin(kStart), 0.0, -std::cos(kStart))));
    scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(-kStart, Vec3::UnitY()));
    scene.bodies.back().mass = 1.0;
    for (BodyDef& body : scene.bodies) body.material.friction = 0.0;
    World world(ordered(scene));
    const double before = energy(world);
    advance(world, 1.6);
    return (before - energy(world)) / (kGravity * kRadius);
  };
  const auto [setting, step] = GetParam();
  for (const Vec3& size : {Vec3(0.2, 0.1, 0.05), Vec3(0.1, 0.1, 0.1)})
    for (const int tiles : {12, 24})
      EXPECT_NEAR(lost(size, tiles, setting, step), lost(size, tiles, Fidelity::Reference, 1.0 / 240.0), 3e-3)
          << tiles << " tiles, " << size.transpose();
}

// What falls by five times its size in a step, onto a plate of a hundredth of it, stays on it. At `interactive` 8 of 180 went
// through: what landed turned on in one segment, however fast it now was; and a point that came out on the other side of the plate
// counted as open.
TEST_P(Landing, NothingFallsThroughAThinPlateInALongStep) {
  constexpr double kSize = 0.01, kFall = 11.0;  // m; g h^2, sizes
  const std::vector<Shape> shapes{Box{Vec3::Constant(kSize)},         Capsule{0.01 * kSize, 0.5 * kSize},
                                  Cylinder{0.5 * kSize, 0.1 * kSize}, Box{{kSize, 0.1 * kSize, 0.1 * kSize}},
                                  Cone{0.5 * kSize, kSize},           Box{{kSize, kSize, 0.02 * kSize}}};
  const double step = std::get<1>(GetParam());
  std::mt19937_64 random(1);
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> share;
  for (int k = 0; k < 180; ++k) {
    SceneDef scene = emptySpace(step);
    scene.gravity = -kFall * kSize / (step * step) * Vec3::UnitZ();
    scene.fidelity = std::get<0>(GetParam());
    scene.bodies.push_back(
        box("plate", {40.0 * kSize, 40.0 * kSize, 0.01 * kSize}, {0.0, 0.0, -0.005 * kSize}));
    scene.bodies.back().kind = BodyKind::Static;
    scene.bodies.push_back(
        body("body", shapes[k % shapes.size()], kSize * (0.9 + 4.0 * share(random)) * Vec3::UnitZ()));
    BodyDef& def = scene.bodies.back();
    def.pose.q_WB = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    def.twist.w_WB = share(random) / step * Vec3(normal(random), normal(random), normal(random));
    World world(ordered(scene));
    for (int n = 0; n < 3; ++n) world.step();
    EXPECT_GT(stateOf(world, "body").pose.p_WB.z(), -0.01 * kSize) << "body " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, Landing,
                         ::testing::Combine(::testing::Values(Fidelity::Interactive, Fidelity::Accurate,
                                                              Fidelity::Reference),
                                            ::testing::Values(1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0)));

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// What statics says to stand does not move at the default setting, nor at the exact ones; what it says to
// fall does.
#include "make_scene.h"

#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0;
constexpr std::array kSettings{Fidelity::Interactive, Fidelity::Accurate, Fidelity::Reference};

Quat about(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}

// The largest way of a body, m.
double wayIn(const SceneDef& scene, double seconds) {
  World world(ordered(scene));
  const Snapshot start = world.snapshot();
  advance(world, seconds);
  const Snapshot end = world.snapshot();
  double way = 0.0;
  for (std::size_t k = 0; k < end.states.size(); ++k)
    way = std::max(way, (end.states[k].pose.p_WB - start.states[k].pose.p_WB).norm());
  return way;
}

// It stands to the tolerance of the exact step, or falls, in 3 s.
void expectStands(SceneDef scene, bool stands, const std::string& what) {
  for (const Fidelity setting : kSettings) {
    scene.fidelity = setting;
    const double way = wayIn(scene, 3.0);
    if (stands)
      EXPECT_LE(way, 1e-8) << what << " at " << fidelityName(setting);
    else
      EXPECT_GE(way, 0.1) << what << " at " << fidelityName(setting);
  }
}

// n blocks of 1 m over the edge of a base. The k-th from the top may hang 1/(2k) m over the one below: then
// the centre of mass of the k upper ones is over its edge. `share` of that is taken.
TEST(Standing, OverhangsOfBlocks) {
  for (const int n : {1, 3, 5, 8, 12})
    for (const double share : {0.9, 0.95, 0.99, 1.02}) {
      SceneDef scene = onFloor(kStep, 0.6);
      BodyDef base = box("base", Vec3::Ones(), {0.0, 0.0, 0.5});
      base.kind = BodyKind::Static;
      scene.bodies.push_back(base);
      double x = 0.0;
      for (int k = n; k >= 1; --k) {
        x += share * 0.5 / k;
        scene.bodies.push_back(box("", {1.0, 0.5, 0.2}, {x, 0.0, 1.1 + 0.2 * (n - k)}));
      }
      expectStands(scene, share < 1.0, std::to_string(n) + " blocks at " + std::to_string(share));
    }
}

// A log on two that touch needs friction of tan 15° = 0.268 at all contacts.
TEST(Standing, ThreeLogs) {
  constexpr double r = 0.2;
  for (const Shape& shape : {Shape(Cylinder{r, 0.5}), Shape(Capsule{r, 0.5}), Shape(Cylinder{r, 0.1})})
    for (const double mu : {0.25, 0.28, 0.3, 0.4, 0.6}) {
      SceneDef scene = onFloor(kStep, mu);
      for (const auto& [x, z] : {std::pair(-r, r), std::pair(r, r), std::pair(0.0, r + std::sqrt(3.0) * r)}) {
        BodyDef log = body("", shape, {x, 0.0, z});
        log.pose.q_WB = about(Vec3::UnitX(), 0.5 * kPi);
        log.material.friction = mu;
        scene.bodies.push_back(log);
      }
      expectStands(scene, mu > 0.268, shapeName(shape) + "s with friction " + std::to_string(mu));
    }
}

// Half a circle of n wedges, without mortar: it stands while its line of thrust stays within it, above a
// thickness of 0.11 radii from the middle (Couplet 1730; Milankovitch 1907).
TEST(Standing, Arches) {
  for (const auto& [n, thickness] :
       {std::pair(5, 0.2), std::pair(7, 0.2), std::pair(9, 0.2), std::pair(15, 0.2), std::pair(9, 0.3),
        std::pair(25, 0.2), std::pair(15, 0.04)}) {
    SceneDef scene = onFloor(kStep, 0.8);
    for (int k = 0; k < n; ++k) {
      std::vector<Vec3> corners;
      for (const int end : {k, k + 1})
        for (const double r : {1.0, 1.0 + thickness})
          for (const double y : {-0.25, 0.25})
            corners.emplace_back(-r * std::cos(kPi * end / n), y, r * std::sin(kPi * end / n));
      const PlacedHull wedge = makeHull(corners, "wedge");
      BodyDef def = body("", wedge.hull, Vec3::Zero());
      def.pose = wedge.poseOfB(Pose{});
      def.material.friction = 0.8;
      scene.bodies.push_back(def);
    }
    expectStands(scene, thickness > 0.1,
                 std::to_string(n) + " wedges, " + std::to_string(thickness) + " thick");
  }
}

// Two planks lean on each other, at an angle a from the vertical. At the floor they need friction of tan(a)/2
// at most. Their edges meet along the normal of one of the two faces: so they need tan(a) there.
TEST(Standing, TwoPlanksThatLean) {
  for (const double mu : {0.5, 0.6, 0.9})
    for (const double angle : {0.2, 0.3, 0.4}) {
      SceneDef scene = onFloor(kStep, mu);
      for (const double side : {-1.0, 1.0}) {
        BodyDef plank = box("", {0.05, 0.4, 1.0}, Vec3::Zero());
        plank.material.friction = mu;
        plank.pose.q_WB = about(Vec3::UnitY(), -side * angle);
        plank.pose.p_WB.x() = side * reach(plank.shape, plank.pose.q_WB.conjugate() * Vec3(-side, 0.0, 0.0));
        plank.pose.p_WB.z() = reach(plank.shape, plank.pose.q_WB.conjugate() * -Vec3::UnitZ());
        scene.bodies.push_back(plank);
      }
      expectStands(scene, true,
                   "planks with friction " + std::to_string(mu) + " at " + std::to_string(angle));
    }
}

// A light ball under a block of a ton rolls out from under it as the block tips: no faster than the block's
// fall by the ball's diameter could drive it, with a gear of two.
TEST(Standing, ALightBallUnderAHeavyBlockIsNotSquirtedOut) {
  for (const auto& [mass, offset, radius] : {std::tuple(0.1, 0.05, 0.1), std::tuple(0.1, 0.2, 0.05),
                                             std::tuple(0.01, 0.1, 0.1), std::tuple(1.0, 0.3, 0.1)}) {
    SceneDef scene = onFloor(kStep, 0.5);
    BodyDef low = box("low", Vec3::Ones(), {0.0, 0.0, 0.5}),
            high = box("high", Vec3::Ones(), {0.0, 0.0, 1.5 + 2.0 * radius});
    BodyDef light = ball("light", radius, {offset, 0.02, 1.0 + radius});
    low.mass = high.mass = 1000.0, light.mass = mass;
    for (const BodyDef& def : {low, light, high}) scene.bodies.push_back(def);
    for (const Fidelity setting : kSettings) {
      scene.fidelity = setting;
      World world(ordered(scene));
      double fastest = 0.0;
      for (int k = 0; k < 180; ++k) {
        world.step();
        for (const BodyState& state : world.snapshot().states)
          fastest = std::max(fastest, state.twist.v_WB.norm());
      }
      EXPECT_LE(fastest, 2.0 * std::sqrt(2.0 * kGravity * 2.0 * radius))
          << mass << " kg at " << fidelityName(setting);
    }
  }
}

// The largest way of a body as seen from the carrier, which began at the origin and moves on with its twist, m.
double wayOnCarrier(const SceneDef& scene, const Twist& carrier, double seconds) {
  World world(ordered(scene));
  const Snapshot start = world.snapshot();
  advance(world, seconds);
  const Snapshot end = world.snapshot();
  const Quat turned = about(carrier.w_WB.norm() > 0.0 ? Vec3(carrier.w_WB.normalized()) : Vec3(Vec3::UnitZ()),
                            carrier.w_WB.norm() * world.time());
  double way = 0.0;
  for (std::size_t k = 0; k < end.states.size(); ++k) {
    const Vec3 wanted = turned * start.states[k].pose.p_WB + world.time() * carrier.v_WB;
    way = std::max(way, (end.states[k].pose.p_WB - wanted).norm());
  }
  return way;
}

// A train, a lift, and a turntable so slow that nothing slides: what stands on the ground stands there. So high stacks and so
// unequal masses need the exact step.
TEST(Standing, WhatStandsOnTheGroundStandsOnACarrier) {
  for (const double step : {1.0 / 30.0, kStep})
    for (const Twist& carrier : {Twist{{0.2, 0.1, 0.0}, Vec3::Zero()}, Twist{{3.0, -1.0, 0.0}, Vec3::Zero()},
                                 Twist{{0.0, 0.0, 1.0}, Vec3::Zero()}, Twist{Vec3::Zero(), {0.0, 0.0, 0.1}}})
      for (const int boxes : {2, 20}) {
        SceneDef scene;
        scene.step = step;
        scene.bodies.push_back(box("carrier", {6.0, 6.0, 0.2}, {0.0, 0.0, -0.1}));
        scene.bodies[0].kind = BodyKind::Kinematic;
        for (int k = 0; k < boxes; ++k) {
          scene.bodies.push_back(box("", Vec3::Constant(0.2), {2.0, 0.0, 0.1 + 0.2 * k}));
          if (boxes == 2) scene.bodies.back().mass = k == 0 ? 1.0 : 100.0;
        }
        for (BodyDef& def : scene.bodies) {
          def.material.friction = 0.6;
          def.twist.w_WB = carrier.w_WB;
          def.twist.v_WB = carrier.v_WB + carrier.w_WB.cross(def.pose.p_WB);
        }
        for (const Fidelity setting : kSettings) {
          scene.fidelity = setting;
          EXPECT_LE(wayOnCarrier(scene, carrier, 3.0), 2e-6)
              << boxes << " at " << fidelityName(setting) << ", v " << carrier.v_WB.transpose();
        }
      }
}

// A lift, or a tray that goes to and fro, which is given another velocity each step, up to 0.6 g upwards and 0.2 g sideways at
// 1 Hz. At `interactive` a box crept by 2 % of its size in 6 s, and stacks of three of 20 mm fell.
TEST(Standing, WhatIsGivenAnotherVelocityEachStepCarriesItsLoad) {
  for (const Fidelity setting : {Fidelity::Interactive, Fidelity::Accurate})
    for (const double size : {0.02, 0.1, 0.5})
      for (const int boxes : {1, 3})
        for (const Vec3& most : {Vec3(0.0, 0.0, 0.2), Vec3(0.0, 0.0, 0.6), Vec3(0.1, 0.0, 0.0)}) {
          SceneDef scene;
          scene.step = kStep;
          scene.fidelity = setting;
          scene.bodies.push_back(box("carrier", {1.0, 1.0, 0.1}, Vec3::Zero()));
          scene.bodies[0].kind = BodyKind::Kinematic;
          for (int k = 0; k < boxes; ++k)
            scene.bodies.push_back(
                box("box_" + std::to_string(k), Vec3::Constant(size), {0.0, 0.0, 0.05 + size * (k + 0.5)}));
          for (BodyDef& def : scene.bodies) def.material.friction = 0.6;
          World world(ordered(scene));
          const double rate = 2.0 * kPi;
          for (int step = 0; world.time() < 6.0; ++step) {
            BodyEdit edit;
            edit.twist = Twist{kGravity / rate * std::sin(rate * (step + 0.5) * kStep) * most, Vec3::Zero()};
            world.editBody(world.find("carrier"), edit);
            world.step();
          }
          const Vec3 carrier = stateOf(world, "carrier").pose.p_WB;
          for (int k = 0; k < boxes; ++k) {
            const Vec3 place = stateOf(world, "box_" + std::to_string(k)).pose.p_WB - carrier;
            EXPECT_LE((place - Vec3(0.0, 0.0, 0.05 + size * (k + 0.5))).norm(), 0.02 * size)
                << boxes << " of " << size << " at " << fidelityName(setting) << ", " << most.transpose()
                << " g";
          }
        }
}

// Two boxes at rest, and a heavy one is put on them, or one of three becomes heavy or light.
TEST(Standing, AnEditOfMassesMovesNothing) {
  for (const double step : {1.0 / 30.0, kStep, 1.0 / 120.0})
    for (const double ratio : {10.0, 100.0, 1e3, 1e4})
      for (const std::string& edit : {"added", "heavy", "light"}) {
        SceneDef scene = onFloor(step, 0.6);
        for (int k = 0; k < (edit == "added" ? 2 : 3); ++k)
          scene.bodies.push_back(box("box_" + std::to_string(k), {0.4, 0.4, 0.2}, {0.0, 0.0, 0.1 + 0.2 * k}));
        for (BodyDef& def : scene.bodies)
          if (def.kind == BodyKind::Dynamic) def.mass = edit == "light" ? ratio : 1.0;
        World world(ordered(scene));
        advance(world, 1.0);
        BodyDef heavy = box("box_2", {0.4, 0.4, 0.2}, {0.0, 0.0, 0.5});
        heavy.mass = ratio;
        heavy.material.friction = 0.6;
        if (edit == "added") world.addBody(heavy);
        BodyEdit mass;
        mass.mass = edit == "heavy" ? ratio : 1.0;
        if (edit != "added") world.editBody(world.find(edit == "heavy" ? "box_2" : "box_0"), mass);
        for (int k = 0; k < 100; ++k) {
          world.step();
          for (int body = 0; body < 3; ++body)
            ASSERT_NEAR(stateOf(world, "box_" + std::to_string(body)).pose.p_WB.z(), 0.1 + 0.2 * body, 2e-3)
                << edit << " 1 : " << ratio << " at a step of " << step;
        }
      }
}

// A cylinder or capsule of 20 to 500 mm that lies on two edges as on rails, with and without friction. A slot that is nearly as
// wide as the body wedges it, so that only small steps hold it at the fast settings.
TEST(Standing, RoundBodiesRestOnTwoEdges) {
  for (const Fidelity setting :
       {Fidelity::Preview, Fidelity::Interactive, Fidelity::Accurate, Fidelity::Reference})
    for (const double step : {kStep, 1.0 / 240.0})
      for (const double friction : {0.0, 0.6})
        for (const bool is_capsule : {false, true})
          for (const double size : {0.02, 0.1, 0.5})
            for (const double slot : {0.3, 0.5, 0.7}) {
              const double radius = 0.5 * size, half = 0.5 * slot * size;
              const double height = std::sqrt(radius * radius - half * half);
              SceneDef scene;
              scene.step = step;
              scene.fidelity = setting;
              for (const double side : {-1.0, 1.0}) {
                scene.bodies.push_back(
                    box("", {size, 3.0 * size, size}, {side * (half + radius), 0.0, -radius}));
                scene.bodies.back().kind = BodyKind::Static;
              }
              const Shape shape = is_capsule ? Shape(Capsule{radius, size}) : Shape(Cylinder{radius, size});
              scene.bodies.push_back(body("log", shape, {0.0, 0.0, height}));
              scene.bodies.back().pose.q_WB = about(Vec3::UnitX(), 0.5 * kPi);
              for (BodyDef& def : scene.bodies) def.material.friction = friction;
              World world(ordered(scene));
              advance(world, 2.0);
              const std::string what = std::string(fidelityName(setting)) +
                                       (is_capsule ? ", capsule" : ", cylinder") + " of " +
                                       std::to_string(size) + ", slot " + std::to_string(slot);
              EXPECT_NEAR(stateOf(world, "log").pose.p_WB.z(), height, 0.12 * height) << what;
              EXPECT_LE(stateOf(world, "log").twist.v_WB.norm(), 1e-4) << what;
            }
}

// A log or a ball that lies on a free cube, over its middle or beside it, does not roll off by itself.
TEST(Standing, RoundBodiesLieOnAFreeCube) {
  for (const double step : {kStep, 1.0 / 120.0})
    for (const double size : {0.01, 0.1})
      for (const double aside : {0.0, 0.1}) {
        const double radius = 0.4 * size;
        for (const Shape& shape :
             {Shape(Sphere{radius}), Shape(Capsule{radius, 0.5 * size}), Shape(Cylinder{radius, 0.8 * size})})
          for (const Fidelity setting : kSettings) {
            SceneDef scene = onFloor(step, 0.6);
            scene.fidelity = setting;
            scene.bodies.push_back(box("cube", Vec3::Constant(size), {0.0, 0.0, 0.5 * size}));
            scene.bodies.push_back(body("log", shape, {aside * size, 0.0, size + radius}));
            scene.bodies.back().pose.q_WB = about(Vec3::UnitX(), 0.5 * kPi);
            for (BodyDef& def : scene.bodies) def.material.friction = 0.6;
            EXPECT_LE(wayIn(scene, 4.0), 1e-3 * size) << fidelityName(setting) << ", size " << size
                                                      << ", aside " << aside << ", shape " << shape.index();
          }
      }
}

// Where edges meet, the normals of two faces separate the planks alike. The contact keeps the one that it has: with the other
// one in each step, all forces of a house of cards were found anew in each step.
TEST(Standing, CardsThatLeanKeepTheirNormals) {
  for (const Fidelity setting : kSettings) {
    SceneDef scene = readScene(findScene(RBS_SCENES, "card_house")).scene;
    scene.fidelity = setting;
    World world(ordered(scene));
    advance(world, 1.0);
    constexpr int kSteps = 60;
    std::map<std::pair<BodyId, BodyId>, Vec3> normals;
    int turned = 0;
    std::uint32_t iterations = 0;
    for (int step = 0; step < kSteps; ++step) {
      for (const IslandResiduals& island : world.step().residuals) iterations += island.iterations;
      for (const ContactPoint& point : world.contacts()) {
        if (!(point.normal_impulse > 0.0)) continue;
        const auto [known, fresh] = normals.try_emplace({point.a, point.b}, point.n_W);
        if (!fresh && (known->second - point.n_W).norm() > 1e-6) ++turned, known->second = point.n_W;
      }
    }
    EXPECT_GE(normals.size(), 15u) << "edges that lean on each other";
    EXPECT_EQ(turned, 0) << fidelityName(setting);
    EXPECT_LE(iterations, 8u * kSteps) << fidelityName(setting);
  }
}

}  // namespace
}  // namespace rbs::test

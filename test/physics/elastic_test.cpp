// SPDX-License-Identifier: BSD-3-Clause
// Elastic bodies of every shape: no impact without friction changes the energy, however a body turns.
#include "make_scene.h"

#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace rbs::test {
namespace {

struct NamedShape {
  std::string name;
  Shape shape;
};

std::vector<NamedShape> shapes() {
  std::vector<Vec3> corners;
  for (int k = 0; k < 5; ++k) corners.emplace_back(0.2 * std::cos(1.3 * k), 0.2 * std::sin(1.3 * k), 0.1 * k);
  return {{"box", Box{{0.3, 0.4, 0.5}}},      {"plate", Box{{0.5, 0.5, 0.02}}},
          {"needle", Box{{0.02, 0.02, 1.0}}}, {"ball", Sphere{0.2}},
          {"capsule", Capsule{0.1, 0.2}},     {"cylinder", Cylinder{0.2, 0.15}},
          {"cone", Cone{0.2, 0.4}},           {"hull", makeHull(corners, "hull").hull}};
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  Vec3 vector(double most) { return {between(-most, most), between(-most, most), between(-most, most)}; }
  Quat orientation() {
    const Vec3 x = vector(1.0);
    return Quat(between(-1.0, 1.0), x.x(), x.y(), x.z()).normalized();
  }
  std::size_t index(std::size_t size) { return random_() % size; }

 private:
  std::mt19937 random_;
};

struct Change {
  double least = 0.0, most = 0.0;
};

// How far the energy falls and rises until `seconds`, as a share of the kinetic energy at the start.
Change energyChange(World& world, double seconds) {
  const double first = energy(world), scale = world.totals().kinetic_energy;
  Change change;
  while (world.time() < seconds) {
    world.step();
    const double now = (energy(world) - first) / scale;
    change.least = std::min(change.least, now), change.most = std::max(change.most, now);
  }
  return change;
}

// A body with a spin, thrown at a floor.
SceneDef thrown(const NamedShape& shape, double spin, double step, Fidelity fidelity, double e, double mu,
                unsigned seed) {
  Draw draw(seed);
  SceneDef scene = onFloor(step, mu);
  scene.fidelity = fidelity;
  scene.bodies[0].material.restitution = e;
  BodyDef def = body("body", shape.shape, {0.0, 0.0, 1.2});
  def.pose.q_WB = draw.orientation();
  def.twist = {draw.vector(2.0), spin * draw.vector(1.0).normalized()};
  def.material.friction = mu;
  def.material.restitution = e;
  scene.bodies.push_back(def);
  return scene;
}

// Before, nine of ten boxes and needles lost or gained up to all of their energy.
TEST(Elastic, ABodyOnAFloorKeepsItsEnergyAtEverySetting) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : kFidelities)
      for (const double step : {0.1, 1.0 / 60.0, 1.0 / 1000.0})
        for (const double spin : {0.0, 1.0, 10.0, 100.0})
          for (unsigned seed = 0; seed < 4; ++seed) {
            World world(ordered(thrown(shape, spin, step, fidelity, 1.0, 0.0, seed)));
            const BodyState before = stateOf(world, "body");
            const Change change = energyChange(world, 1.5);
            const std::string what = shape.name + " at " + fidelityName(fidelity) + ", step " +
                                     std::to_string(step) + ", spin " + std::to_string(spin) + ", seed " +
                                     std::to_string(seed);
            EXPECT_LE(change.most, 1e-11) << what;
            EXPECT_GE(change.least, -1e-11) << what;
            // Nothing pushes it sideways.
            const Vec3 sideways = stateOf(world, "body").twist.v_WB - before.twist.v_WB;
            EXPECT_LE(sideways.head<2>().norm(), 1e-12 * (1.0 + before.twist.v_WB.norm())) << what;
          }
}

// So it does on a floor that moves along itself: a slab that slides and turns, which does no work without friction. What is round had
// the velocity of the slab taken without its turning about the body's own axis, and gained up to thirty times its energy.
TEST(Elastic, ABodyOnASlabThatTurnsKeepsItsEnergy) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : kFidelities)
      for (const double turning : {-3.0, 0.1, 5.0})
        for (unsigned seed = 0; seed < 6; ++seed) {
          SceneDef scene = thrown(shape, 5.0, 1.0 / 60.0, fidelity, 1.0, 0.0, seed);
          BodyDef& slab = scene.bodies[0];
          slab.shape = Box{{30.0, 30.0, 1.0}};
          slab.kind = BodyKind::Kinematic;
          slab.pose.p_WB = {1.0, -2.0, -0.5};
          slab.twist = {{1.0, 0.5, 0.0}, {0.0, 0.0, turning}};
          World world(ordered(scene));
          const Change change = energyChange(world, 1.5);
          const std::string what = shape.name + " at " + fidelityName(fidelity) + ", a slab that turns at " +
                                   std::to_string(turning) + ", seed " + std::to_string(seed);
          EXPECT_LE(change.most, 1e-11) << what;
          EXPECT_GE(change.least, -1e-11) << what;
        }
}

// So does one in air that is too thin to matter, where drag is a torque on a box all the same.
TEST(Elastic, ThinAirChangesNothing) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : kFidelities)
      for (unsigned seed = 0; seed < 10; ++seed) {
        SceneDef scene = thrown(shape, 10.0, 1.0 / 60.0, fidelity, 1.0, 0.0, seed);
        scene.air = Air{Limits::min_density};
        World world(ordered(scene));
        const Change change = energyChange(world, 2.0);
        EXPECT_LE(change.most, 0.0) << shape.name << " at " << fidelityName(fidelity) << ", seed " << seed;
        EXPECT_GE(change.least, -1e-5) << shape.name << " at " << fidelityName(fidelity) << ", seed " << seed;
      }
}

// Bodies that meet each other and the walls of a room.
SceneDef room(double step, Fidelity fidelity, double e, double mu, unsigned seed) {
  Draw draw(seed);
  SceneDef scene;
  scene.step = step;
  scene.fidelity = fidelity;
  const auto add = [&](BodyDef def) {
    def.material.friction = mu;
    def.material.restitution = e;
    scene.bodies.push_back(def);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      BodyDef wall = box("wall_" + std::to_string(scene.bodies.size()),
                         Vec3::Constant(2.4) - 2.2 * Vec3::Unit(axis), 1.1 * side * Vec3::Unit(axis));
      wall.kind = BodyKind::Static;
      add(wall);
    }
  const std::vector<NamedShape> all = shapes();
  for (int k = 0; k < 8; ++k) {
    const double s = 0.5;
    BodyDef def = body("body_" + std::to_string(k), all[draw.index(all.size())].shape,
                       {k & 1 ? s : -s, k & 2 ? s : -s, k & 4 ? s : -s});
    def.pose.q_WB = draw.orientation();
    def.twist = {draw.vector(3.0), draw.vector(10.0)};
    add(def);
  }
  return scene;
}

TEST(Elastic, BodiesInARoomKeepTheirEnergyAtEverySetting) {
  for (const Fidelity fidelity : kFidelities)
    for (const double step : {0.1, 1.0 / 60.0})
      for (unsigned seed = 0; seed < 6; ++seed) {
        World world(ordered(room(step, fidelity, 1.0, 0.0, seed)));
        const Change change = energyChange(world, 1.0);
        EXPECT_LE(change.most, 1e-11) << fidelityName(fidelity) << ", step " << step << ", seed " << seed;
        EXPECT_GE(change.least, -1e-11) << fidelityName(fidelity) << ", step " << step << ", seed " << seed;
      }
}

// Without weight, and with nothing else there, two bodies keep momentum and angular momentum besides.
TEST(Elastic, TwoBodiesKeepMomentumAndAngularMomentum) {
  const std::vector<NamedShape> all = shapes();
  for (const NamedShape& a : all)
    for (const NamedShape& b : all) {
      Draw draw(7);
      SceneDef scene;
      scene.gravity = Vec3::Zero();
      for (const auto& [name, shape, side] :
           {std::tuple("a", a.shape, -1.0), std::tuple("b", b.shape, 1.0)}) {
        BodyDef def = body(name, shape, {0.8 * side, 0.0, 0.0});
        def.pose.q_WB = draw.orientation();
        def.twist = {Vec3(-2.0 * side, 0.0, 0.0) + draw.vector(0.1), draw.vector(10.0)};
        def.material.friction = 0.0;
        def.material.restitution = 1.0;
        scene.bodies.push_back(def);
      }
      World world(ordered(scene));
      const Totals before = world.totals();
      std::uint64_t impacts = 0;
      while (world.time() < 1.0) impacts += world.step().impacts;
      const Totals after = world.totals();
      EXPECT_GT(impacts, 0u) << a.name << " and " << b.name;
      const double scale = 1.0 + before.momentum.norm() + before.angular_momentum.norm();
      EXPECT_NEAR(after.kinetic_energy, before.kinetic_energy, 1e-11 * before.kinetic_energy)
          << a.name << " and " << b.name;
      EXPECT_LE((after.momentum - before.momentum).norm(), 1e-12 * scale) << a.name << " and " << b.name;
      EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(), 1e-11 * scale)
          << a.name << " and " << b.name;
    }
}

// Elastic bodies thrown on elastic boxes at rest: what touches already, the soft step rebounds. Without its
// limit on the energy of a rebound a step gained up to half of the energy.
TEST(Elastic, BodiesThrownOnOthersAtRestGainNothing) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Draw draw(seed);
    SceneDef scene = onFloor(1.0 / 60.0, 0.0);
    scene.fidelity = Fidelity::Interactive;
    scene.bodies[0].material.restitution = 1.0;
    for (int k = 0; k < 4; ++k) {
      scene.bodies.push_back(box("carrier_" + std::to_string(k), {0.5, 0.5, 0.3}, {0.52 * k, 0.0, 0.15}));
      BodyDef def = draw.between(0.0, 1.0) < 0.5
                        ? box("body_" + std::to_string(k), Vec3::Constant(0.25) + draw.vector(0.15), {})
                        : body("body_" + std::to_string(k), Cylinder{0.15, 0.2}, {});
      def.pose = {Vec3(0.52 * k, 0.0, 1.0) + draw.vector(0.3), draw.orientation()};
      def.twist = {Vec3(0.0, 0.0, -3.0) + draw.vector(2.0), draw.vector(10.0)};
      scene.bodies.push_back(def);
    }
    for (BodyDef& def : scene.bodies) def.material.friction = 0.0, def.material.restitution = 1.0;
    World world(ordered(scene));
    const double scale = world.totals().kinetic_energy;
    double least = energy(world), gain = 0.0;
    while (world.time() < 2.0) {
      world.step();
      gain = std::max(gain, (energy(world) - least) / scale);
      least = std::min(least, energy(world));
    }
    EXPECT_LE(gain, 1e-3) << "seed " << seed;
  }
}

// Friction and loss only take away. Within this time no body comes to rest.
TEST(Elastic, WithFrictionAndLossNothingIsGained) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : kFidelities)
      for (const double e : {1.0, 0.9})
        for (unsigned seed = 0; seed < 6; ++seed) {
          World world(ordered(thrown(shape, 10.0, 1.0 / 60.0, fidelity, e, 0.5, seed)));
          EXPECT_LE(energyChange(world, 1.0).most, 1e-9)
              << shape.name << " at " << fidelityName(fidelity) << ", e " << e << ", seed " << seed;
        }
}

// A rebound that hardly opens a gap is none: the number of impacts of a body that comes to rest is bounded.
TEST(Elastic, BouncingToRestTakesFewImpacts) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : kFidelities)
      for (unsigned seed = 0; seed < 12; ++seed) {
        World world(ordered(thrown(shape, 10.0, 1.0 / 60.0, fidelity, 0.5, 0.5, seed)));
        std::uint64_t most = 0;
        while (world.time() < 2.0) most = std::max<std::uint64_t>(most, world.step().impacts);
        EXPECT_LE(most, 100u) << shape.name << " at " << fidelityName(fidelity) << ", seed " << seed;
      }
}

// Elastic but rough, a body rattles on: friction takes what it has, and its bounces get smaller without end.
// Before, such a cone took 10 s for a step.
TEST(Elastic, RattlingInACornerTakesABoundedNumberOfImpacts) {
  for (const NamedShape& shape : shapes())
    for (const Fidelity fidelity : {Fidelity::Interactive, Fidelity::Accurate}) {
      SceneDef scene = thrown(shape, 10.0, 1.0 / 60.0, fidelity, 1.0, 0.5, 1);
      for (const double side : {-1.0, 1.0}) {
        BodyDef wall = scene.bodies[0];
        wall.name = side > 0.0 ? "wall_east" : "wall_west";
        wall.pose.p_WB.x() = 0.7 * side;
        wall.pose.q_WB = Eigen::AngleAxisd(-0.5 * kPi * side, Vec3::UnitY());
        scene.bodies.push_back(wall);
      }
      World world(ordered(scene));
      std::uint64_t most = 0;
      while (world.time() < 4.0) most = std::max<std::uint64_t>(most, world.step().impacts);
      EXPECT_LE(most, 3000u) << shape.name << " at " << fidelityName(fidelity);
    }
}

}  // namespace
}  // namespace rbs::test

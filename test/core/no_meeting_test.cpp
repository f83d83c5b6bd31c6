// SPDX-License-Identifier: BSD-3-Clause
// Bodies that may meet no others, by their masks or since collision is switched off, against the same bodies alone.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

// Bodies of every shape that rest, rebound and roll among each other and on a floor, in the air or not, with the
// kinematic ones that some scenes have.
SceneDef randomScene(std::mt19937& random) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  const auto vector = [&](double most) {
    return Vec3(uniform(-most, most), uniform(-most, most), uniform(-most, most));
  };
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  if (uniform(0.0, 1.0) < 0.6) scene.air = Air{}, scene.wind = Wind{{uniform(-3.0, 3.0), 0.0, 0.0}};
  const auto count = static_cast<int>(uniform(2.0, 8.0));
  for (int k = 0; k < count; ++k) {
    const double size = uniform(0.2, 0.6);
    const std::array<Shape, 5> shapes{Sphere{size / 2.0}, Box{Vec3::Constant(size)},
                                      Capsule{size / 4.0, size}, Cylinder{size / 2.0, size},
                                      Cone{size / 2.0, size}};
    BodyDef def = body("body_" + std::to_string(k), shapes[random() % shapes.size()],
                       {uniform(-0.8, 0.8), uniform(-0.8, 0.8), uniform(0.3, 3.0)});
    def.twist = {vector(1.0), vector(5.0)};
    if (uniform(0.0, 1.0) < 0.1) def.kind = BodyKind::Kinematic;
    if (uniform(0.0, 1.0) < 0.4) def.material.restitution = 0.7;
    scene.bodies.push_back(def);
  }
  return scene;
}

// The scene of one body of a world, as it is now.
SceneDef alone(const World& world, const std::string& name) {
  SceneDef scene = world.capture();
  const auto isOther = [&](const BodyDef& def) { return def.name != name; };
  scene.bodies.erase(std::remove_if(scene.bodies.begin(), scene.bodies.end(), isOther), scene.bodies.end());
  return scene;
}

void expectEqual(const BodyState& a, const BodyState& b, const std::string& what) {
  EXPECT_LE((a.pose.p_WB - b.pose.p_WB).norm(), 1e-9) << what;
  EXPECT_LE(a.pose.q_WB.angularDistance(b.pose.q_WB), 1e-9) << what;
  EXPECT_LE((a.twist.v_WB - b.twist.v_WB).norm(), 1e-9) << what;
  EXPECT_LE((a.twist.w_WB - b.twist.w_WB).norm(), 1e-9) << what;
}

class NoMeeting : public ::testing::TestWithParam<Fidelity> {};

TEST_P(NoMeeting, BodiesAmongOthersMoveAsIfAlone) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    SceneDef scene = randomScene(random);
    scene.fidelity = GetParam();
    std::vector<std::string> lone;
    for (BodyDef& def : scene.bodies)
      if (def.name != "floor" && random() % 2 == 0) def.mask = 0, lone.push_back(def.name);
    World world(scene);
    std::vector<World> worlds;
    for (const std::string& name : lone) worlds.emplace_back(alone(world, name));
    advance(world, 0.5);
    for (std::size_t k = 0; k < lone.size(); ++k) {
      advance(worlds[k], 0.5);
      expectEqual(stateOf(world, lone[k]), stateOf(worlds[k], lone[k]),
                  lone[k] + " of seed " + std::to_string(seed));
    }
  }
}

// The contacts of the step before must not go on pushing, and must not be reported.
TEST_P(NoMeeting, BodiesPartAsSoonAsNoneMayMeet) {
  for (const bool by_masks : {false, true}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      std::mt19937 random(seed);
      SceneDef scene = randomScene(random);
      scene.fidelity = GetParam();
      World world(scene);
      advance(world, 1.5);  // most lie on the floor
      if (by_masks) {
        BodyEdit edit;
        edit.mask = 0;
        for (const BodyDef& def : scene.bodies) world.editBody(world.find(def.name), edit);
      } else {
        world.setEffects({{Effect::Collision, false}});
      }
      std::vector<World> worlds;
      for (const BodyDef& def : scene.bodies) worlds.emplace_back(alone(world, def.name));
      World resumed(world.capture(), world.captureState());
      advance(world, 0.25);
      advance(resumed, 0.25);
      const std::string what =
          " of seed " + std::to_string(seed) + (by_masks ? " by masks" : " by the effect");
      EXPECT_EQ(world.snapshot().contacts.size(), 0u) << what;
      EXPECT_EQ(world.stateHash(), resumed.stateHash()) << what;
      for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
        advance(worlds[k], 0.25);
        const std::string& name = scene.bodies[k].name;
        expectEqual(stateOf(world, name), stateOf(worlds[k], name), name + what);
      }
    }
  }
}

TEST_P(NoMeeting, SleepersFallWhenCollisionIsSwitchedOff) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = GetParam();
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("crate", Vec3::Constant(0.4), {0.0, 0.0, 0.2}));
  World world(scene);
  advance(world, GetParam() == Fidelity::Preview ? 15.0 : 4.0);
  world.setEffects({{Effect::Collision, false}});
  const double z = stateOf(world, "crate").pose.p_WB.z();
  advance(world, 1.0);
  EXPECT_NEAR(z - stateOf(world, "crate").pose.p_WB.z(), kGravity / 2.0, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Settings, NoMeeting, ::testing::ValuesIn(kFidelities),
                         [](const auto& info) { return std::string(fidelityName(info.param)); });

}  // namespace

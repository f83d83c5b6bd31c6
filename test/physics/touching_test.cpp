// SPDX-License-Identifier: BSD-3-Clause
// For how many steps two bodies have touched: told by closed forms of what falls, bounces, rests and is taken away, and over
// the catalogue by the impulses that are reported.
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0;

using Pair = std::pair<BodyId, BodyId>;

// Of each pair with points: the steps that it has touched, equal at all its points.
std::map<Pair, std::uint64_t> touchingOf(const World& world) {
  std::map<Pair, std::uint64_t> touching;
  for (const ContactPoint& point : world.contacts()) {
    const auto [place, fresh] = touching.try_emplace({point.a, point.b}, point.touching_steps);
    EXPECT_EQ(place->second, point.touching_steps);
  }
  return touching;
}

// Of the only pair of a world; 0 where it has no points.
std::uint64_t touching(const World& world) {
  const auto all = touchingOf(world);
  EXPECT_LE(all.size(), 1u);
  return all.empty() ? 0 : all.begin()->second;
}

// A millionth of the lighter one's weight, over a step, N s.
double leastOf(const World& world, const ContactPoint& point) {
  double mass = std::numeric_limits<double>::infinity();
  for (const BodyId id : {point.a, point.b}) {
    const Snapshot now = world.snapshot();
    const BodyDescription& body = (*now.bodies)[now.find(id)];
    if (body.kind == BodyKind::Dynamic) mass = std::min(mass, body.mass);
  }
  return std::max(1e-6 * mass * world.scene().gravity.norm() * world.scene().step, 1e-300);
}

class Touching : public testing::TestWithParam<Fidelity> {
 protected:
  SceneDef sceneOf(const BodyDef& body) const {
    SceneDef scene = onFloor(kStep, 0.5);
    scene.fidelity.preset = GetParam();
    scene.effects[Effect::Sleeping] = true;
    scene.bodies.push_back(body);
    return scene;
  }
};

INSTANTIATE_TEST_SUITE_P(Settings, Touching, testing::ValuesIn(kFidelities),
                         [](const auto& info) { return fidelityName(info.param); });

TEST_P(Touching, BeginsAsItLandsAndGoesOnAsleep) {
  for (const BodyDef& falling :
       {box("box", {0.4, 0.3, 0.2}, {0.0, 0.0, 0.4}), ball("ball", 0.2, {0.0, 0.0, 0.5})}) {
    for (const SceneDef& scene : inBothOrders(sceneOf(falling))) {
      World world(scene);
      // It falls 0.3 m in 0.2473 s: within the step of number 15.
      for (int k = 1; k <= 14; ++k) {
        world.step();
        EXPECT_EQ(touching(world), 0u) << k;
      }
      for (std::uint64_t k = 1; k <= 120; ++k) {
        world.step();
        EXPECT_EQ(touching(world), k);
      }
      EXPECT_STREQ(stateOf(world, falling.name).method, "asleep");
      World resumed(world.capture(), world.captureState());
      resumed.step();
      EXPECT_EQ(touching(resumed), 121u);
    }
  }
}

TEST_P(Touching, BeginsAnewWithEachBounce) {
  SceneDef scene = sceneOf(ball("ball", 0.1, {0.0, 0.0, 1.1}));
  for (BodyDef& body : scene.bodies) body.material.restitution = 1.0;
  World world(scene);
  int bounces = 0;
  for (int k = 0; k < 300; ++k) {
    world.step();
    const std::uint64_t now = touching(world);
    EXPECT_LE(now, 1u) << k;
    bounces += now == 1;
  }
  // The first after 0.4515 s, the others 0.903 s apart, as far as the setting keeps the height.
  EXPECT_GE(bounces, 5);
  EXPECT_LE(bounces, 7);
}

// Between two plates, once to and fro in each step: it touches both in all of them, and never for two.
TEST_P(Touching, BeginsAnewInEachStep) {
  SceneDef scene = emptySpace(kStep);
  scene.fidelity.preset = GetParam();
  scene.bodies = {box("low", {1.0, 1.0, 0.2}, {0.0, 0.0, -0.21}),
                  box("high", {1.0, 1.0, 0.2}, {0.0, 0.0, 0.21}), ball("ball", 0.1, Vec3::Zero())};
  scene.bodies[0].kind = scene.bodies[1].kind = BodyKind::Static;
  scene.bodies[2].twist.v_WB.z() = 0.04 / kStep;
  for (BodyDef& body : scene.bodies) body.material.restitution = 1.0, body.material.friction = 0.0;
  World world(ordered(scene));
  for (int k = 0; k < 10; ++k) {
    world.step();
    const auto all = touchingOf(world);
    EXPECT_EQ(all.size(), 2u) << k;
    for (const auto& [pair, steps] : all) EXPECT_EQ(steps, 1u) << k;
  }
}

TEST_P(Touching, EndsWithTheLastPush) {
  World world(sceneOf(box("box", {0.4, 0.3, 0.2}, {0.0, 0.0, 0.1})));
  const BodyId id = world.find("box");
  for (int k = 0; k < 30; ++k) world.step();
  EXPECT_EQ(touching(world), 30u);

  BodyEdit edit;
  edit.twist = Twist{{0.0, 0.0, 1.0}, Vec3::Zero()};
  world.editBody(id, edit);
  world.step();
  EXPECT_EQ(touching(world), 0u) << "thrown up";

  edit.twist = Twist{};
  edit.pose = world.pose(id);
  edit.pose->p_WB.z() = 0.1;
  world.editBody(id, edit);
  EXPECT_EQ(touching(world), 0u) << "put down";
  for (std::uint64_t k = 1; k <= 10; ++k) EXPECT_EQ(touching((world.step(), world)), k);

  world.editBody(id, edit);
  for (std::uint64_t k = 1; k <= 10; ++k) EXPECT_EQ(touching((world.step(), world)), k) << "put there anew";
}

TEST_P(Touching, NeedsAPush) {
  SceneDef scene = emptySpace(kStep);
  scene.fidelity.preset = GetParam();
  scene.bodies = {box("a", Vec3::Constant(0.5), Vec3::Zero()),
                  box("b", Vec3::Constant(0.5), {0.5, 0.0, 0.0})};
  World world(scene);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(touching((world.step(), world)), 0u);
  world.applyImpulse(world.find("b"), {-1.0, 0.0, 0.0}, {0.5, 0.0, 0.0});
  EXPECT_EQ(touching((world.step(), world)), 1u);
}

TEST_P(Touching, GoesOnWhereARunIsResumed) {
  SceneDef scene = sceneOf(box("box", {0.4, 0.3, 0.2}, {0.0, 0.0, 0.4}));
  scene.bodies.push_back(ball("ball", 0.1, {0.02, 0.0, 1.2}));
  scene.bodies.back().material.restitution = 0.7;
  World world(scene);
  for (int k = 0; k < 160; ++k) {
    world.step();
    if (k % 8 != 3) continue;
    World resumed(world.capture(), world.captureState());
    EXPECT_EQ(touchingOf(resumed), touchingOf(world)) << k;
    World other = world;
    for (int more = 0; more < 4; ++more) {
      resumed.step(), other.step();
      EXPECT_EQ(touchingOf(resumed), touchingOf(other)) << k << " + " << more;
    }
  }
}

TEST_P(Touching, IsNoLongerThanTheRun) {
  World world(sceneOf(box("box", {0.4, 0.3, 0.2}, {0.0, 0.0, 0.1})));
  for (int k = 0; k < 7; ++k) world.step();
  SavedState state = world.captureState();
  ASSERT_EQ(state.contacts.at(0).touching_steps, 7u);
  state.contacts[0].touching_steps = 8;
  try {
    World resumed(world.capture(), state);
    ADD_FAILURE() << "taken";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("no more steps of touching than the 7 of the scene"),
              std::string::npos)
        << error.what();
  }
}

// What falls asleep in the step in which it is put down touches since then, also where a step has several divisions. An older
// file does not say for how long its sleepers have touched.
TEST_P(Touching, BeginsAsleep) {
  for (const double step : {0.5, 1.0})
    for (const std::uint32_t divisions : {1u, 60u}) {
      SceneDef scene = sceneOf(box("box", {0.4, 0.3, 0.2}, {0.0, 0.0, 0.1}));
      scene.step = step;
      scene.fidelity.divisions = divisions;
      World world(ordered(scene));
      for (std::uint64_t k = 1; k <= 4; ++k) {
        world.step();
        EXPECT_EQ(touching(world), k) << step << " s, " << divisions;
      }
      EXPECT_STREQ(stateOf(world, "box").method, "asleep");
      SavedState older = world.captureState();
      older.contacts.at(0).touching_steps = 0;
      World resumed(world.capture(), older);
      for (std::uint64_t k = 1; k <= 3; ++k) EXPECT_EQ(touching((resumed.step(), resumed)), k);
    }
}

// Rounding is no push.
TEST_P(Touching, IsMoreThanRounding) {
  SceneDef scene = sceneOf(box("long", {4.0, 0.3, 0.2}, {0.0, 0.0, 0.1}));
  scene.bodies.push_back(box("beside", {0.4, 0.3, 0.2}, {0.0, 0.3, 0.1}));
  scene.bodies.back().twist.v_WB.x() = 0.5;
  for (BodyDef& body : scene.bodies) body.material.friction = 0.1;
  World world(ordered(scene));
  for (int k = 0; k < 60; ++k) {
    world.step();
    std::map<Pair, double> pushed;
    for (const ContactPoint& point : world.contacts())
      pushed[{point.a, point.b}] = std::max(pushed[{point.a, point.b}], point.normal_impulse);
    for (const auto& [pair, steps] : touchingOf(world))
      EXPECT_EQ(steps > 0, pushed[pair] > 1e-9) << k << ": " << pushed[pair];
  }
}

// A pair touches in a step if and only if one of its points pushes in it, and counts up by one or begins anew.
TEST_P(Touching, IsToldByImpulses) {
  std::uint64_t began = 0, went_on = 0;
  for (const auto& [name, property] : listScenes(RBS_SCENES)) {
    SceneDef scene = readScene(findScene(RBS_SCENES, name)).scene;
    scene.fidelity.preset = GetParam();
    if (scene.bodies.size() > 70) continue;
    World world(ordered(scene));
    std::map<Pair, std::uint64_t> before;
    for (int k = 0; k < 60; ++k) {
      world.step();
      std::map<Pair, double> pushed;
      for (const ContactPoint& point : world.contacts()) {
        double& most = pushed[{point.a, point.b}];
        most = std::max(most, point.normal_impulse / leastOf(world, point));
      }
      const std::map<Pair, std::uint64_t> now = touchingOf(world);
      for (const auto& [pair, steps] : now) {
        if (pushed[pair] <= 1.0) {
          EXPECT_EQ(steps, 0u) << name;
        } else {
          EXPECT_TRUE(steps == 1 || (before[pair] > 0 && steps == before[pair] + 1)) << name << ": " << steps;
          began += steps == 1, went_on += steps > 1;
        }
      }
      before = now;
    }
  }
  EXPECT_GT(began, 200u);
  EXPECT_GT(went_on, 2000u);
}

}  // namespace
}  // namespace rbs::test

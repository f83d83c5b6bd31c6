// SPDX-License-Identifier: BSD-3-Clause
// The analysis: that an edit looks only at the bodies it is about, and comes to what a look at all would.
#include "step/analyse_scene.h"

#include "base/random.h"
#include "make_scene.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

TEST(SceneAnalysis, AnEditLooksAtTheBodiesItIsAbout) {
  constexpr std::uint64_t kBodies = 10000;
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  for (std::uint64_t k = 1; k < kBodies; ++k)
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.1, {0.3 * (k % 100), 0.3 * (k / 100), 0.1}));
  World world(scene);
  const auto looks = [&](const auto& edit) {
    const std::uint64_t before = world.bodiesAnalysed();
    edit();
    return world.bodiesAnalysed() - before;
  };
  BodyId added;
  EXPECT_EQ(looks([&] { added = world.addBody(ball("new", 0.1, {0.0, 0.0, 5.0})); }), 1u);
  BodyEdit edit;
  edit.friction = 0.3;
  edit.shape = Box{{0.1, 0.2, 0.3}};
  // The first box asks for gyroscopic torque, which all may feel from then on; the second is like it.
  EXPECT_EQ(looks([&] { world.editBody(added, edit); }), 1u + kBodies + 1u);
  EXPECT_EQ(looks([&] { world.editBody(world.find("ball_7"), edit); }), 1u);
  EXPECT_EQ(looks([&] { world.applyImpulse(added, {0.1, 0.0, 0.0}, Vec3::Zero()); }), 0u);
  EXPECT_EQ(looks([&] { world.grab(added, Grab{}); }), 2u);  // lets go of what else holds it, and pulls
  EXPECT_EQ(looks([&] { world.release(added); }), 1u);
  EXPECT_EQ(looks([&] {
              world.addBodies({ball("", 0.1, {0, 0, 6}), ball("", 0.1, {0, 0, 7}), ball("", 0.1, {0, 0, 8})});
            }),
            3u);
  EXPECT_EQ(looks([&] { world.removeBody(world.find("ball_50")); }), 0u);
  EXPECT_EQ(looks([&] { world.setGravity({0.0, 0.0, -5.0}); }), kBodies + 3u);
}

BodyDef randomBody(SplitMix64& random) {
  const Vec3 p(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(0.5, 4.0));
  BodyDef def = body("", Sphere{0.2}, p);
  if (random.below(2) == 0) def.shape = Box{{0.2, 0.3, random.below(2) ? 0.2 : 0.3}};
  if (random.below(8) == 0)
    def.shape = Plane{}, def.kind = BodyKind::Static, def.pose.p_WB.setZero();
  else if (random.below(6) == 0)
    def.kind = random.below(2) ? BodyKind::Static : BodyKind::Kinematic;
  if (random.below(3) == 0) def.group = 2;
  if (random.below(3) == 0) def.mask = static_cast<std::uint32_t>(random.below(4));
  def.material.friction = random.below(2) ? 0.5 : 0.0;
  if (random.below(4) == 0) def.material.restitution = 0.5;
  if (random.below(6) == 0) def.material.rolling_resistance = 0.1;
  if (random.below(3) == 0) def.material.drag_coefficient = 0.0;
  return def;
}

// A few bodies, so that edits often change what the others feel, or whom they may meet.
void editAtRandom(World& world, SplitMix64& random) {
  const Snapshot now = world.snapshot();
  if (now.states.empty() || random.below(4) == 0) {
    world.addBody(randomBody(random));
    return;
  }
  const std::size_t k = random.below(now.states.size());
  const BodyId id = now.states[k].id;
  const bool dynamic = (*now.bodies)[k].kind == BodyKind::Dynamic,
             plane = std::holds_alternative<Plane>((*now.bodies)[k].shape);
  BodyEdit edit;
  switch (random.below(9)) {
    case 0:
    case 1:
      world.removeBody(id);
      break;
    case 2:
      edit.friction = random.below(2) ? 0.5 : 0.0;
      edit.restitution = random.below(2) ? 0.5 : 0.0;
      edit.rolling_resistance = random.below(2) ? 0.1 : 0.0;
      world.editBody(id, edit);
      break;
    case 3:
      if (!plane) edit.shape = random.below(2) ? Shape(Sphere{0.2}) : Shape(Box{{0.2, 0.3, 0.4}});
      world.editBody(id, edit);
      break;
    case 4:
      if (!plane) edit.kind = random.below(2) ? BodyKind::Dynamic : BodyKind::Static;
      world.editBody(id, edit);
      break;
    case 5:
      if (dynamic) world.grab(id, Grab{});
      break;
    case 6:
      if (!plane) world.hold(id, now.states[k].pose);
      break;
    case 7:
      world.release(id);
      break;
    case 8:
      random.below(2) ? world.setAir(Air{}) : world.setAir(std::nullopt);
      break;
  }
}

TEST(SceneAnalysis, OfAnEditIsWhatALookAtAllWouldFind) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SplitMix64 random(seed);
    World world{SceneDef{}};
    for (int k = 0; k < 25; ++k) {
      editAtRandom(world, random);
      World anew(world);
      anew.setFidelity(anew.scene().fidelity);  // takes the analysis of all
      const std::vector<StageInfo> found = world.pipeline(), wanted = anew.pipeline();
      for (std::size_t row = 0; row < wanted.size(); ++row) {
        ASSERT_EQ(found[row].active, wanted[row].active)
            << "seed " << seed << ", edit " << k << ": " << wanted[row].name;
        ASSERT_EQ(found[row].reason, wanted[row].reason)
            << "seed " << seed << ", edit " << k << ": " << wanted[row].name;
        ASSERT_EQ(found[row].items, wanted[row].items)
            << "seed " << seed << ", edit " << k << ": " << wanted[row].name;
      }
      world.step(), anew.step();
      ASSERT_EQ(world.stateHash(), anew.stateHash()) << "seed " << seed << ", edit " << k;
    }
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// What holds of a pair, whichever of the two bodies is the older: every scene is made in both orders.
#include "make_scene.h"

#include <gtest/gtest.h>

namespace rbs::test {
namespace {

class PairOrder : public testing::TestWithParam<Fidelity> {
 protected:
  // Runs a scene in both orders for some seconds, and hands over how it ends.
  template <class Check>
  void inEachOrder(SceneDef scene, double seconds, Check check) {
    scene.fidelity = GetParam();
    for (const SceneDef& one : inBothOrders(scene)) {
      SCOPED_TRACE("the oldest body is " + one.bodies.front().name);
      World world(one);
      advance(world, seconds);
      check(world);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Settings, PairOrder, testing::ValuesIn(kFidelities),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

BodyDef kinematicBox(const std::string& name, const Vec3& size, const Vec3& p_W, const Vec3& v_W) {
  BodyDef def = box(name, size, p_W);
  def.kind = BodyKind::Kinematic;
  def.twist.v_WB = v_W;
  return def;
}

SceneDef underGravity() {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.gravity = Vec3(0.0, 0.0, -kGravity);
  return scene;
}

TEST_P(PairOrder, ABeltCarriesABoxAtItsSpeed) {
  SceneDef scene = underGravity();
  scene.bodies = {kinematicBox("belt", Vec3(20.0, 2.0, 1.0), Vec3(0.0, 0.0, -0.5), Vec3(1.0, 0.0, 0.0)),
                  box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5))};
  inEachOrder(scene, 1.0, [](const World& world) {
    EXPECT_NEAR(stateOf(world, "crate").twist.v_WB.x(), 1.0, 1e-3);
    EXPECT_NEAR(stateOf(world, "crate").pose.p_WB.z(), 0.5, 2e-2);
  });
}

TEST_P(PairOrder, ALiftRaisesABox) {
  SceneDef scene = underGravity();
  scene.bodies = {kinematicBox("lift", Vec3(2.0, 2.0, 1.0), Vec3(0.0, 0.0, -0.5), Vec3(0.0, 0.0, 0.5)),
                  box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5))};
  inEachOrder(scene, 1.0, [](const World& world) {
    EXPECT_NEAR(stateOf(world, "crate").twist.v_WB.z(), 0.5, 1e-3);
    EXPECT_NEAR(stateOf(world, "crate").pose.p_WB.z(), 1.0, 2e-2);
  });
}

TEST_P(PairOrder, ATurntableTurnsABoxAndABallWithTorsionalResistance) {
  SceneDef scene = underGravity();
  BodyDef table = kinematicBox("table", Vec3(4.0, 4.0, 1.0), Vec3(0.0, 0.0, -0.5), Vec3::Zero());
  table.twist.w_WB.z() = 1.0;
  table.material.torsional_resistance = 0.2;
  BodyDef marble = ball("marble", 0.5, Vec3(0.0, 0.0, 0.5));
  marble.material.torsional_resistance = 0.2;
  scene.bodies = {table, marble};
  inEachOrder(scene, 1.0,
              [](const World& world) { EXPECT_NEAR(stateOf(world, "marble").twist.w_WB.z(), 1.0, 1e-3); });
  scene.bodies[1] = box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5));
  inEachOrder(scene, 1.0,
              [](const World& world) { EXPECT_NEAR(stateOf(world, "crate").twist.w_WB.z(), 1.0, 2e-2); });
}

TEST_P(PairOrder, ABoxLeavesAWallThatHitsItAtTwiceTheSpeedOfTheWall) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies = {kinematicBox("wall", Vec3(1.0, 3.0, 3.0), Vec3(-1.5, 0.0, 0.0), Vec3(2.0, 0.0, 0.0)),
                  box("crate", Vec3::Ones(), Vec3::Zero())};
  for (BodyDef& def : scene.bodies) def.material.restitution = 1.0;
  inEachOrder(scene, 1.0, [](const World& world) {
    EXPECT_LE((stateOf(world, "crate").twist.v_WB - Vec3(4.0, 0.0, 0.0)).norm(), 1e-9);
    EXPECT_LE(stateOf(world, "crate").twist.w_WB.norm(), 1e-9);
  });
}

TEST_P(PairOrder, ABoxStopsAfterItsBrakingDistanceOnABlock) {
  SceneDef scene = underGravity();
  BodyDef block = box("block", Vec3(20.0, 2.0, 1.0), Vec3(5.0, 0.0, -0.5)),
          sled = box("sled", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1));
  block.kind = BodyKind::Static;
  block.material.friction = sled.material.friction = 0.4;
  sled.twist.v_WB.x() = 3.0;
  scene.bodies = {block, sled};
  const double expected = 9.0 / (2.0 * 0.4 * kGravity);
  inEachOrder(scene, 2.0, [&](const World& world) {
    EXPECT_NEAR(stateOf(world, "sled").pose.p_WB.x(), expected, 0.05 * expected);
    EXPECT_LE(stateOf(world, "sled").twist.v_WB.norm(), 1e-3);
  });
}

TEST_P(PairOrder, ALightBodyIsHitByAHeavyOneAsTheClosedFormSays) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies = {ball("heavy", 0.5, Vec3(-2.0, 0.0, 0.0)), ball("light", 0.5, Vec3::Zero())};
  scene.bodies[0].mass = 3.0, scene.bodies[1].mass = 1.0;
  scene.bodies[0].twist.v_WB.x() = 4.0;
  for (BodyDef& def : scene.bodies) def.material.restitution = 0.5;
  inEachOrder(scene, 1.0, [](const World& world) {  // light: m1 (1 + e) v/(m1 + m2)
    EXPECT_NEAR(stateOf(world, "light").twist.v_WB.x(), 3.0 * 1.5 * 4.0 / 4.0, 1e-9);
    EXPECT_NEAR(stateOf(world, "heavy").twist.v_WB.x(), 4.0 - 1.5 * 4.0 / 4.0, 1e-9);
  });
}

// A sleeper is woken by what comes near, by forces or led, whichever is the older.
TEST_P(PairOrder, ASleeperWakesWhateverCame) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.fidelity = GetParam();
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("crate", Vec3::Constant(0.4), Vec3(0.0, 0.0, 0.2)));
  BodyDef falling = ball("falling", 0.15, Vec3(0.0, 0.0, 60.0));  // for 3.5 s
  BodyDef pusher = kinematicBox("pusher", Vec3(0.2, 1.0, 0.4), Vec3(-2.0, 0.0, 0.3), Vec3(0.5, 0.0, 0.0));
  for (const BodyDef& waker : {falling, pusher}) {
    SceneDef with = scene;
    with.bodies.push_back(waker);
    for (const SceneDef& one : inBothOrders(with)) {
      SCOPED_TRACE(waker.name + ", the oldest body is " + one.bodies.front().name);
      World world(one);
      const auto asleep = [&] {
        for (const StageInfo& stage : world.pipeline())
          if (stage.name == "sleep.wake") return stage.items;
        return std::uint64_t{0};
      };
      advance(world, 2.8);
      if (asleep() == 0u) advance(world, 0.2);  // preview takes longer to rest
      ASSERT_EQ(asleep(), 1u);
      for (int k = 0; k < 96 && asleep() > 0u; ++k) world.step();
      EXPECT_EQ(asleep(), 0u);
      advance(world, 1.6);
      if (waker.name == "pusher") EXPECT_GT(stateOf(world, "crate").pose.p_WB.x(), 0.2);
    }
  }
}

// A body falls through another unless each has the group of the other in its mask.
TEST_P(PairOrder, BothMasksMustAllowACollision) {
  for (const auto& [mask_floor, mask_box, rests] : {std::tuple(2u, 1u, true), std::tuple(2u, 4u, false),
                                                    std::tuple(4u, 1u, false), std::tuple(4u, 4u, false)}) {
    SceneDef scene = underGravity();
    BodyDef ground = box("ground", Vec3(2.0, 2.0, 1.0), Vec3(0.0, 0.0, -0.5)),
            crate = box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5));
    ground.kind = BodyKind::Static;
    ground.group = 1, ground.mask = mask_floor;
    crate.group = 2, crate.mask = mask_box;
    scene.bodies = {ground, crate};
    inEachOrder(scene, 0.5, [&, rests = rests](const World& world) {
      EXPECT_EQ(stateOf(world, "crate").pose.p_WB.z() > 0.4, rests) << mask_floor << " " << mask_box;
    });
  }
}

// An edit voids the forces of a body, whichever it is of the pair: those of a heavy body would shoot a light
// one away.
TEST_P(PairOrder, ABodyThatIsMadeLightKeepsNoForces) {
  SceneDef scene = underGravity();
  BodyDef ground = box("ground", Vec3(2.0, 2.0, 1.0), Vec3(0.0, 0.0, -0.5)),
          crate = box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5));
  ground.kind = BodyKind::Static;
  crate.mass = 1e6;
  scene.bodies = {ground, crate};
  inEachOrder(scene, 0.5, [](World& world) {
    BodyEdit edit;
    edit.mass = 1.0;
    world.editBody(world.find("crate"), edit);
    world.step();
    EXPECT_LE(stateOf(world, "crate").twist.v_WB.norm(), 0.1);
  });
}

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// Bodies that sleep, against the same bodies awake.
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

// Three crates on top of each other, one apart, and a ball that waits at a distance.
SceneDef crates(bool sleeping) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  for (int k = 0; k < 3; ++k)
    scene.bodies.push_back(box("crate_" + std::to_string(k), Vec3::Constant(0.4), {0.0, 0.0, 0.2 + 0.4 * k}));
  scene.bodies.push_back(box("apart", Vec3::Constant(0.4), {5.0, 0.0, 0.2}));
  if (sleeping) scene.effects[Effect::Sleeping] = true;
  return scene;
}

std::uint64_t asleep(const World& world) {
  for (const StageInfo& stage : world.pipeline())
    if (stage.name == "sleep.wake") return stage.items;
  return 0;
}

TEST(Sleep, IsOffUnlessAskedFor) {
  World world(crates(false));
  advance(world, 3.0);
  EXPECT_EQ(asleep(world), 0u);
}

TEST(Sleep, GroupsAtRestAreLeftOutAndStayAsTheyAre) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = crates(true);
    scene.fidelity = fidelity;
    World world(scene);
    advance(world, 0.4);
    EXPECT_EQ(asleep(world), 0u);
    advance(world, fidelity == Fidelity::Preview ? 15.0 : 4.0);
    ASSERT_EQ(asleep(world), 4u) << fidelityName(fidelity);
    const Snapshot before = world.snapshot();
    advance(world, 5.0);
    const Snapshot after = world.snapshot();
    EXPECT_EQ(after.report.flying + after.report.islands + after.report.pairs, 0u);
    EXPECT_EQ(after.contacts.size(), before.contacts.size());
    EXPECT_GT(after.contacts.size(), 12u);
    for (std::size_t k = 0; k < after.states.size(); ++k) {
      EXPECT_EQ(after.states[k].pose.p_WB, before.states[k].pose.p_WB);
      EXPECT_EQ(after.states[k].pose.q_WB.coeffs(), before.states[k].pose.q_WB.coeffs());
    }
    EXPECT_NEAR(after.totals.potential_energy, before.totals.potential_energy, 0.0);
  }
}

// A crowd is moved apart without velocities: its bodies are no faster than what rests.
TEST(Sleep, NobodyDoesInACrowd) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.fidelity = Fidelity::Accurate;
  scene.effects[Effect::Sleeping] = true;
  for (int k = 0; k < 60; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Constant(1.0), {0.0, 0.0, 0.5}));
  World world(scene);
  advance(world, 1.0);
  EXPECT_EQ(asleep(world), 0u);
}

TEST(Sleep, TheStepInWhichItBeginsTellsTheTimesOfItsStages) {
  World world(crates(true));
  for (int k = 0; k < 300 && asleep(world) == 0; ++k) world.step();
  ASSERT_GT(asleep(world), 0u);
  for (const StageInfo& stage : world.pipeline())
    if (stage.name == "islands.advance" || stage.name == "contacts.solve")
      EXPECT_GT(stage.seconds, 0.0) << stage.name;
}

// A sleeper may have a kinematic body at rest beside it, which is nobody's to solve. What falls onto that body is
// looked at with what is around it.
TEST(Sleep, GoesOnBesideAKinematicBodyThatSomethingStrikes) {
  for (const Fidelity fidelity : kFidelities)
    for (const double restitution : {0.0, 0.5}) {
      SceneDef scene = crates(true);
      scene.fidelity = fidelity;
      scene.bodies.push_back(box("wall", {0.4, 2.0, 0.4}, {5.403, 0.0, 0.2}));
      scene.bodies.back().kind = BodyKind::Kinematic;
      const double lands = fidelity == Fidelity::Preview ? 15.0 : 4.0;
      for (int k = 0; k < 3; ++k) {
        const double height = 0.5 + 0.5 * kGravity * lands * lands + 0.5 * k;
        scene.bodies.push_back(ball("falling_" + std::to_string(k), 0.1, {5.403, 0.5 * (k - 1), height}));
        scene.bodies.back().material.restitution = restitution;
      }
      World world(scene);
      advance(world, lands - 0.1);
      ASSERT_EQ(asleep(world), 4u) << fidelityName(fidelity);
      const Vec3 before = stateOf(world, "apart").pose.p_WB;
      advance(world, 0.4);
      EXPECT_GT(stateOf(world, "falling_0").twist.v_WB.z(), -10.0) << "it has not landed";
      EXPECT_EQ(stateOf(world, "apart").pose.p_WB, before) << fidelityName(fidelity);
    }
}

// The wind changes with time: what it does not move now it may move later.
TEST(Sleep, WhatStandsInTheWindStaysAwake) {
  for (const bool wind : {false, true}) {
    SceneDef scene = crates(true);
    scene.air = Air{};
    if (wind) scene.wind = Wind{Vec3(0.5, 0.0, 0.0)};
    World world(scene);
    advance(world, 4.0);
    EXPECT_EQ(asleep(world), wind ? 0u : 4u);
    EXPECT_LT(stateOf(world, "apart").twist.v_WB.norm(), 1e-6) << "else it is awake because it moves";
  }
}

// A mouse that rests, or a push that friction holds: the next command of either moves the body, though it
// wakes nobody.
TEST(Sleep, WhatIsPulledStaysAwake) {
  World world(crates(true));
  const BodyId apart = world.find("apart"), top = world.find("crate_2");
  Grab grab;
  grab.p_W = {5.0, 0.0, 0.2};
  world.grab(apart, grab);
  const Vec3 at = stateOf(world, "crate_2").pose.p_WB;
  world.commandWrench(top, {10.0, 0.0, 0.0}, Vec3::Zero(), at, 100.0);
  advance(world, 3.0);
  EXPECT_EQ(asleep(world), 0u);
  grab.p_W = {5.0, 1.0, 0.4};
  world.grab(apart, grab);
  world.commandWrench(top, {2000.0, 0.0, 0.0}, Vec3::Zero(), at, 0.3);
  advance(world, 0.5);
  EXPECT_GT(stateOf(world, "apart").pose.p_WB.y(), 0.5);
  EXPECT_GT(stateOf(world, "crate_2").pose.p_WB.x(), 0.2);
}

// A body that is held is at rest where it is to be: it came to no more than rounding of it before, for ever.
TEST(Sleep, ABodyThatIsHeldComesToRest) {
  std::mt19937 random(1);
  const auto draw = [&] { return random() / 2147483648.0 - 1.0; };
  const auto quaternion = [&] {
    const double x = draw(), y = draw(), z = draw();
    return Quat(draw(), x, y, z).normalized();
  };
  for (const double h : {1.0 / 1000.0, 1.0 / 240.0, 1.0 / 60.0})
    for (int k = 0; k < 30; ++k) {
      SceneDef scene = emptySpace(h);
      scene.bodies.push_back(box("held", {0.3, 0.4, 0.5}, {draw(), draw(), draw()}));
      scene.bodies.back().pose.q_WB = quaternion();
      World world(scene);
      world.hold(world.find("held"), {Vec3(3.0 * draw(), draw(), draw()), quaternion()});
      advance(world, 3.0);
      EXPECT_TRUE(stateOf(world, "held").twist.v_WB.isZero(0.0)) << "step " << h << ", start " << k;
      EXPECT_TRUE(stateOf(world, "held").twist.w_WB.isZero(0.0)) << "step " << h << ", start " << k;
    }
}

TEST(Sleep, GoesOnBesideABodyThatIsHeldStill) {
  SceneDef scene = crates(true);
  scene.bodies.push_back(box("held", Vec3::Constant(0.4), {5.5, 0.0, 0.2}));
  World world(scene);
  world.hold(world.find("held"), {Vec3(5.41, 0.001, 0.2), Quat(Eigen::AngleAxisd(1e-3, Vec3::UnitZ()))});
  advance(world, 4.0);
  EXPECT_TRUE(stateOf(world, "held").twist.v_WB.isZero(0.0));
  EXPECT_TRUE(stateOf(world, "held").twist.w_WB.isZero(0.0));
  EXPECT_EQ(asleep(world), 4u);
}

// Slower than what counts as rest, a kinematic body still carries what stands on it.
TEST(Sleep, WhatRidesOnACreepingBodyStaysAwake) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.effects[Effect::Sleeping] = true;
  scene.bodies.push_back(box("raft", {2.0, 2.0, 0.2}, {0.0, 0.0, 1.0}));
  scene.bodies.back().kind = BodyKind::Kinematic;
  scene.bodies.back().twist.v_WB = {5e-5, 0.0, 0.0};
  scene.bodies.push_back(box("rider", Vec3::Constant(0.4), {0.0, 0.0, 1.3}));
  World world(scene);
  for (int k = 0; k < 1200; ++k) {
    world.step();
    ASSERT_EQ(asleep(world), 0u) << "step " << k;
  }
  EXPECT_NEAR(stateOf(world, "rider").pose.p_WB.x(), 1e-3, 1e-4);
}

// Nothing slows a ball that spins about the vertical at its only point of contact. Its centre is at rest.
TEST(Sleep, WhatSpinsOnTheSpotStaysAwake) {
  for (const Fidelity fidelity : kFidelities)
    for (const double spin : {0.0, 0.01, 3.0}) {
      SceneDef scene = onFloor(1.0 / 60.0, 0.6);
      scene.effects[Effect::Sleeping] = true;
      scene.fidelity = fidelity;
      scene.bodies.push_back(ball("ball", 0.15, {0.0, 0.0, 0.15}));
      scene.bodies.back().twist.w_WB.z() = spin;
      World world(scene);
      advance(world, 4.0);
      EXPECT_EQ(asleep(world), spin > 0.0 ? 0u : 1u) << fidelityName(fidelity) << ", " << spin << " rad/s";
      EXPECT_NEAR(stateOf(world, "ball").twist.w_WB.z(), spin, 1e-9 * spin) << fidelityName(fidelity);
    }
}

TEST(Sleep, TheEndOfAWrenchIsNoEditAndWakesNobody) {
  SceneDef scene = crates(true);
  scene.bodies.push_back(box("sled", Vec3::Constant(0.4), {0.0, 20.0, 0.2}));
  World world(scene);
  world.applyWrench(world.find("sled"), {0.0, 2000.0, 0.0}, Vec3::Zero(), {0.0, 20.0, 0.2}, 4.5);
  const std::uint64_t edits = world.edits();
  advance(world, 4.4);
  ASSERT_EQ(asleep(world), 4u);
  advance(world, 0.2);
  const double speed = stateOf(world, "sled").twist.v_WB.y();
  advance(world, 0.5);
  EXPECT_LT(stateOf(world, "sled").twist.v_WB.y(), speed);
  EXPECT_EQ(asleep(world), 4u);
  EXPECT_EQ(world.edits(), edits);
}

// A blow wakes the whole group before it lands: the bodies go where they would have gone had they never
// slept.
TEST(Sleep, ABlowFindsThemAwake) {
  // By the exact step: what a shot does to a stack of soft contacts hangs on the last digits of its sag.
  const auto strike = [](bool sleeping) {
    SceneDef scene = crates(sleeping);
    scene.fidelity = Fidelity::Accurate;
    World world(scene);
    advance(world, 4.0);
    EXPECT_EQ(asleep(world), sleeping ? 4u : 0u);
    BodyDef shot = ball("shot", 0.15, {-2.0, 0.0, 1.0});
    shot.twist.v_WB = {6.0, 0.0, 2.0};
    world.addBody(shot);
    EXPECT_EQ(asleep(world), 0u);  // an edit wakes all
    advance(world, 1.0);
    return world.snapshot();
  };
  // Without sleep, a stack that is 1e-11 m off at the start ends 4e-7 m off.
  const Snapshot slept = strike(true), woke = strike(false);
  for (std::size_t k = 0; k < slept.states.size(); ++k)
    EXPECT_LE((slept.states[k].pose.p_WB - woke.states[k].pose.p_WB).norm(), 1e-6) << (*slept.bodies)[k].name;
}

TEST(Sleep, WhatComesNearWakesTheGroupItComesNearAndNoOther) {
  SceneDef scene = crates(true);
  scene.bodies.push_back(ball("high", 0.15, {0.05, 0.0, 60.0}));
  World world(scene), awake([&] {
    SceneDef other = scene;
    other.effects.clear();
    return other;
  }());
  advance(world, 3.0);
  advance(awake, 3.0);
  ASSERT_EQ(asleep(world), 4u);
  while (asleep(world) == 4u && world.time() < 5.0) world.step(), awake.step();
  EXPECT_EQ(asleep(world), 1u);  // "apart"
  EXPECT_EQ(world.step().warnings.size(), 0u);
  awake.step();
  // The ball falls on the top crate with the same impulse.
  EXPECT_NEAR(stateOf(world, "high").twist.v_WB.z(), stateOf(awake, "high").twist.v_WB.z(), 0.02);
  EXPECT_NEAR(stateOf(world, "crate_2").twist.v_WB.z(), stateOf(awake, "crate_2").twist.v_WB.z(), 0.02);
}

TEST(Sleep, ABodyThatIsLedWakesWhatItComesNear) {
  SceneDef scene = crates(true);
  BodyDef pusher = box("pusher", {0.2, 1.0, 0.4}, {3.0, 0.0, 0.3});
  pusher.kind = BodyKind::Kinematic;
  pusher.twist.v_WB.x() = 0.4;
  scene.bodies.push_back(pusher);
  World world(scene);
  advance(world, 3.0);
  ASSERT_EQ(asleep(world), 4u);
  advance(world, 4.0);
  EXPECT_GT(stateOf(world, "apart").pose.p_WB.x(), 5.5);
}

TEST(Sleep, AnEditOfWhatCarriesThemWakesThem) {
  World world(crates(true));
  advance(world, 4.0);
  ASSERT_EQ(asleep(world), 4u);
  world.removeBody(world.find("crate_0"));
  advance(world, 1.0);
  EXPECT_NEAR(stateOf(world, "crate_1").pose.p_WB.z(), 0.2, 0.005);
  world.applyImpulse(world.find("crate_2"), {0.0, 0.0, 100.0}, stateOf(world, "crate_2").pose.p_WB);
  world.step();
  EXPECT_GT(stateOf(world, "crate_2").twist.v_WB.z(), 0.5);
}

TEST(Sleep, ComesWithoutTheLocationOfImpactsToo) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = crates(true);
    scene.fidelity = fidelity;
    scene.effects[Effect::Impacts] = false;
    World world(scene);
    advance(world, fidelity == Fidelity::Preview ? 15.0 : 4.0);
    EXPECT_EQ(asleep(world), 4u) << fidelityName(fidelity);
  }
}

// With everything asleep no stage looks for pairs, whatever is forced on.
TEST(Sleep, OfAllEndsWhatIsOfContacts) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = crates(true);
    scene.fidelity = fidelity;
    for (const Effect effect : {Effect::Impacts, Effect::Restitution, Effect::Rolling})
      scene.effects[effect] = true;
    for (BodyDef& def : scene.bodies) def.material.restitution = 0.3;
    World world(scene);
    advance(world, fidelity == Fidelity::Preview ? 15.0 : 4.0);
    ASSERT_EQ(asleep(world), 4u) << fidelityName(fidelity);
    World resumed(world.capture(), world.captureState());
    for (int k = 0; k < 5; ++k) world.step(), resumed.step();
    EXPECT_EQ(world.stateHash(), resumed.stateHash());
    for (const StageInfo& stage : world.pipeline())
      if (stage.name == "impacts.predict") EXPECT_FALSE(stage.active) << stage.reason;
  }
}

TEST(Sleep, OnAKinematicBodyAtRestKeepsItsContacts) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = fidelity;
    scene.effects[Effect::Sleeping] = true;
    scene.bodies.push_back(box("table", {2.0, 2.0, 0.2}, {0.0, 0.0, 1.0}));
    scene.bodies.back().kind = BodyKind::Kinematic;
    scene.bodies.push_back(box("crate", Vec3::Constant(0.4), {0.0, 0.0, 1.3}));
    scene.bodies.back().mass = 10.0;
    World world(scene);
    advance(world, fidelity == Fidelity::Preview ? 15.0 : 4.0);
    ASSERT_EQ(asleep(world), 1u) << fidelityName(fidelity);
    advance(world, 1.0);
    double sum = 0.0;
    for (const ContactPoint& point : world.contacts()) sum += point.normal_impulse;
    EXPECT_NEAR(sum, 10.0 * kGravity / 60.0, 1e-2 * 10.0 * kGravity / 60.0) << fidelityName(fidelity);
  }
}

// Nothing turns a smooth ball, so that its orientation is worked out when it is read. It stays as it is then.
TEST(Sleep, KeepsAnOrientationThatWasNotIntegrated) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.0);
    scene.fidelity = fidelity;
    scene.effects[Effect::Sleeping] = true;
    scene.bodies.push_back(ball("ball", 0.01, {0.0, 0.0, 0.01}));
    scene.bodies.back().material.friction = 0.0;
    scene.bodies.back().twist.w_WB.z() = 0.01;
    World world(scene);
    Quat before = Quat::Identity();
    for (int k = 0; k < 900 && asleep(world) == 0; ++k)
      before = stateOf(world, "ball").pose.q_WB, world.step();
    ASSERT_EQ(asleep(world), 1u) << fidelityName(fidelity);
    EXPECT_LE(stateOf(world, "ball").pose.q_WB.angularDistance(before), 1e-3) << fidelityName(fidelity);
    EXPECT_GT(before.angularDistance(Quat::Identity()), 4e-3);
  }
}

TEST(Sleep, SurvivesSavingBitForBitAndARefusedEdit) {
  World world(crates(true));
  for (const double more : {0.2, 0.2, 4.0}) {
    advance(world, more);
    const SceneFile file = parseScene(writeScene(world.capture(), world.captureState()), "saved.yaml");
    World restored(file.scene, file.state);
    ASSERT_EQ(restored.stateHash(), world.stateHash()) << world.time();
    EXPECT_EQ(asleep(restored), asleep(world));
    World going(file.scene, file.state);
    for (int k = 0; k < 60; ++k) restored.step(), going.step();
    EXPECT_EQ(restored.stateHash(), going.stateHash());
  }
  const std::uint64_t hash = world.stateHash();
  EXPECT_THROW(world.applyImpulse(world.find("crate_0"), Vec3::Constant(std::nan("")), Vec3::Zero()),
               InvalidInput);
  EXPECT_EQ(world.stateHash(), hash);
}

// Bodies that rest beside each other without touching, and that have not come to rest at the same time.
TEST(Sleep, WhatRestsBesideAnotherSleepsWithIt) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = fidelity;
    scene.effects[Effect::Sleeping] = true;
    scene.bodies.push_back(box("early", Vec3::Ones(), {0.0, 0.0, 0.5}));
    scene.bodies.push_back(box("late", Vec3::Ones(), {1.005, 0.0, 0.52}));
    World world(ordered(scene));
    while (world.time() < 3.0) world.step();
    for (int k = 0; k < 5; ++k) EXPECT_EQ(world.step().islands, 0u) << fidelityName(fidelity);
  }
}

// Nothing carries them: their own fluid does, or nothing pulls.
TEST(Sleep, WhatFloatsAtRestSleepsWithoutContacts) {
  for (const Fidelity fidelity : kFidelities)
    for (const double gravity : {-kGravity, -1.6}) {
      SceneDef scene;
      scene.fidelity = fidelity;
      scene.gravity.z() = gravity;
      scene.fluid = Fluid{};
      scene.effects[Effect::Sleeping] = true;
      BodyDef raft = box("raft", {2.0, 2.0, 0.4}, Vec3::Zero());
      raft.density = 500.0;
      BodyDef crate = box("crate", Vec3::Constant(0.5), {5.0, 0.0, 0.25});
      crate.density = 200.0;  // it bobs
      scene.bodies = {raft, crate};
      World world(scene);
      advance(world, 1.0);
      EXPECT_EQ(asleep(world), 1u) << fidelityName(fidelity);
      const double z = stateOf(world, "crate").pose.p_WB.z();
      advance(world, 0.2);
      EXPECT_NE(stateOf(world, "crate").pose.p_WB.z(), z);
      world.applyImpulse(world.find("raft"), Vec3(0.0, 0.0, 10.0), Vec3::Zero());
      advance(world, 0.1);
      EXPECT_EQ(asleep(world), 0u);
      EXPECT_GT(stateOf(world, "raft").pose.p_WB.z(), 1e-5);
    }
}

// At the top of its way a ball is slow, and at the end of a swing.
TEST(Sleep, NobodyDoesWhereAForceTurnsItRound) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    scene.fidelity = fidelity;
    scene.effects[Effect::Sleeping] = true;
    scene.bodies.push_back(ball("thrown", 0.1, {0.0, 0.0, 0.1}));
    scene.bodies.back().twist.v_WB.z() = 1000.5 * kGravity / 60.0;
    World world(scene);
    for (int k = 0; k < 1800; ++k) {
      world.step();
      ASSERT_EQ(asleep(world), 0u) << k;
    }
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Which effects a scene is found to need, what forcing them does, and what is left when it needs none.
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <new>

using namespace rbs;
using namespace rbs::test;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace {
std::size_t allocations = 0;
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace {

StageInfo stage(const World& world, const std::string& name) {
  for (const StageInfo& row : world.pipeline())
    if (row.name == name) return row;
  throw std::out_of_range("no stage '" + name + "'");
}

// Two balls without friction that may meet, in empty space: collisions are all there is.
SceneDef twoBalls() {
  SceneDef scene = emptySpace(1.0 / 60.0);
  for (const double x : {-1.0, 1.0}) {
    scene.bodies.push_back(ball(x < 0 ? "left" : "right", 0.3, {x, 0.0, 0.0}));
    scene.bodies.back().twist = {{-x, 0.1, 0.0}, {0.3, -0.2, 0.7}};
    scene.bodies.back().material.friction = 0.0;
  }
  return scene;
}

struct Need {
  Effect effect;
  std::string stage;
  std::function<void(SceneDef&)> ask;  // makes twoBalls() need it
  std::string reason;                  // a part of it
};

std::vector<Need> needs() {
  const auto both = [](auto change) {
    return [change](SceneDef& scene) {
      for (BodyDef& body : scene.bodies) change(body);
    };
  };
  return {
      {Effect::Gravity, "forces.gravity", [](SceneDef& s) { s.gravity.z() = -1.5; }, "1.5 m/s^2 on 2 bodies"},
      {Effect::Drag, "forces.drag", [](SceneDef& s) { s.air = Air{}; }, "1.2 kg/m^3 on 2 bodies"},
      {Effect::Buoyancy, "forces.buoyancy", [](SceneDef& s) { s.fluid = Fluid{}, s.gravity.z() = -1.0; },
       "1000 kg/m^3"},
      {Effect::Friction, "contacts.friction", both([](BodyDef& b) { b.material.friction = 0.5; }),
       "2 bodies have"},
      {Effect::Rolling, "contacts.rolling",
       [](SceneDef& s) { s.bodies[0].material.rolling_resistance = 0.1; }, "1 body has"},
      {Effect::Restitution, "contacts.restitution",
       [](SceneDef& s) { s.bodies[0].material.restitution = 0.5; }, "1 body has"},
      {Effect::Gyroscopic, "rotation.gyroscopic",
       [](SceneDef& s) {
         s.bodies[0].shape = Box{{0.1, 0.2, 0.3}};
       },
       "1 body has"},
      {Effect::Rotation, "rotation.integrate",
       [](SceneDef& s) {
         s.bodies[0].shape = Box{{0.2, 0.2, 0.2}};
       },
       "1 body of 2"},
  };
}

TEST(Detection, EachEffectIsOnWhereTheSceneAsksForItAndOffElsewhere) {
  for (const Need& need : needs()) {
    SceneDef scene = twoBalls();
    const StageInfo without = stage(World(scene), need.stage);
    EXPECT_FALSE(without.active) << need.stage;
    EXPECT_FALSE(without.reason.empty()) << need.stage;
    need.ask(scene);
    const StageInfo with = stage(World(scene), need.stage);
    EXPECT_TRUE(with.active) << need.stage;
    EXPECT_THAT(with.reason, HasSubstr(need.reason)) << need.stage;
  }
}

TEST(Detection, ForcedOffSaysWhatIsNeglectedAndForcedOnWhatItWouldNotNeed) {
  for (const Need& need : needs()) {
    SceneDef scene = twoBalls();
    scene.effects[need.effect] = true;
    const StageInfo on = stage(World(scene), need.stage);
    EXPECT_TRUE(on.active) << need.stage;
    EXPECT_THAT(on.reason, StartsWith("forced on, although ")) << need.stage;
    need.ask(scene);
    scene.effects[need.effect] = false;
    const StageInfo off = stage(World(scene), need.stage);
    EXPECT_FALSE(off.active) << need.stage;
    EXPECT_THAT(off.reason, StartsWith("forced off, neglecting: ")) << need.stage;
    EXPECT_THAT(off.reason, HasSubstr(need.reason)) << need.stage;
  }
}

// What is forced off does nothing: the run is that of the scene that never asked for it, bit for bit.
TEST(Detection, WhatIsForcedOffIsAsIfItHadNeverBeenMentioned) {
  for (const Need& need : needs()) {
    if (need.effect == Effect::Gyroscopic || need.effect == Effect::Rotation)
      continue;  // asked for by a shape
    SceneDef plain = twoBalls(), forced = twoBalls();
    if (need.effect == Effect::Buoyancy) plain.gravity.z() = -1.0;
    need.ask(forced);
    forced.effects[need.effect] = false;
    // A ball with friction may be turned, and its orientation is then carried along.
    if (need.effect == Effect::Friction || need.effect == Effect::Rolling)
      plain.effects[Effect::Rotation] = true;
    if (need.effect == Effect::Friction || need.effect == Effect::Rolling)
      forced.effects[Effect::Rotation] = true;
    World a(plain), b(forced);
    for (int k = 0; k < 120; ++k) {
      a.step(), b.step();
      for (const char* name : {"left", "right"}) {
        EXPECT_EQ(stateOf(a, name).pose.p_WB, stateOf(b, name).pose.p_WB) << need.stage << " step " << k;
        EXPECT_EQ(stateOf(a, name).pose.q_WB.coeffs(), stateOf(b, name).pose.q_WB.coeffs()) << need.stage;
        EXPECT_EQ(stateOf(a, name).twist.v_WB, stateOf(b, name).twist.v_WB) << need.stage;
        EXPECT_EQ(stateOf(a, name).twist.w_WB, stateOf(b, name).twist.w_WB) << need.stage;
      }
    }
  }
}

TEST(Detection, WithoutCollisionBodiesPassThroughEachOther) {
  SceneDef scene = twoBalls();
  scene.effects[Effect::Collision] = false;
  World world(scene);
  advance(world, 2.0);
  EXPECT_NEAR(stateOf(world, "left").pose.p_WB.x(), 1.0, 1e-12);
  EXPECT_FALSE(stage(world, "broadphase.pairs").active);
  EXPECT_FALSE(stage(world, "contacts.solve").active);
}

// A torque has nothing to turn: the response to it is zero, and its inverse was not a number.
TEST(Detection, WithoutRotationNothingResistsRolling) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(ball("ball", 0.2, {0.0, 0.0, 0.2}));
  scene.bodies.push_back(ball("upper", 0.2, {0.0, 0.0, 0.6}));
  for (BodyDef& def : scene.bodies)
    def.material.rolling_resistance = def.material.torsional_resistance = 0.01;
  scene.effects[Effect::Rotation] = false;
  for (const bool forced : {false, true}) {
    if (forced) scene.effects[Effect::Rolling] = true;
    for (const Fidelity fidelity : kFidelities) {
      scene.fidelity = fidelity;
      World world(scene);
      EXPECT_EQ(stage(world, "contacts.rolling").active, forced);
      for (int k = 0; k < 30; ++k) EXPECT_TRUE(world.step().warnings.empty()) << fidelityName(fidelity);
      EXPECT_NEAR(stateOf(world, "upper").pose.p_WB.z(), 0.6, 1e-2) << fidelityName(fidelity);
    }
  }
}

TEST(Detection, AWrenchOnABodyThatHasBecomeStaticDoesNothing) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(ball("ball", 0.2, Vec3::Zero()));
  World world(scene);
  world.applyWrench(world.find("ball"), Vec3::UnitX(), Vec3::UnitZ(), Vec3::Zero(), 1.0);
  BodyEdit edit;
  edit.kind = BodyKind::Static;
  world.editBody(world.find("ball"), edit);
  advance(world, 0.5);
  EXPECT_EQ(stateOf(world, "ball").pose.p_WB, Vec3::Zero().eval());
  edit.kind = BodyKind::Dynamic;
  world.editBody(world.find("ball"), edit);
  advance(world, 0.5);
  EXPECT_GT(stateOf(world, "ball").pose.p_WB.x(), 0.0);  // it goes on acting
}

TEST(Detection, WithoutRotationABoxSlidesAndKeepsItsAttitude) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies.push_back(box("box", {0.2, 0.2, 1.0}, {0.0, 0.0, 0.5}));
  scene.bodies.back().twist.v_WB.x() = 3.0;
  scene.bodies.back().material.friction = 0.5;
  for (const Fidelity fidelity : kFidelities) {
    scene.fidelity = fidelity;
    scene.effects = {};
    World falls(scene);
    scene.effects[Effect::Rotation] = false;
    World slides(scene);
    advance(falls, 1.0);
    advance(slides, 1.0);
    EXPECT_LT((stateOf(falls, "box").pose.q_WB * Vec3::UnitZ()).z(), 0.9) << fidelityName(fidelity);
    EXPECT_EQ(stateOf(slides, "box").pose.q_WB.coeffs(), Quat::Identity().coeffs()) << fidelityName(fidelity);
    const double stops = 3.0 * 3.0 / (2.0 * 0.5 * kGravity);
    const bool exact = fidelity == Fidelity::Accurate || fidelity == Fidelity::Reference;
    EXPECT_NEAR(stateOf(slides, "box").pose.p_WB.x(), stops, exact ? 1e-9 : 3.0 * scene.step)
        << fidelityName(fidelity);
  }
}

// A spin that nothing may change drags what it touches: the ball is a point with a moving surface.
TEST(Detection, WithoutRotationASpinningBallDrivesItselfAlong) {
  for (const Fidelity fidelity : {Fidelity::Accurate, Fidelity::Reference}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.25);
    scene.fidelity = fidelity;
    scene.effects[Effect::Rotation] = false;
    scene.bodies.push_back(ball("ball", 0.1, {0.0, 0.0, 0.1}));
    scene.bodies.back().material.friction = 0.25;
    scene.bodies.back().twist.w_WB.y() = 10.0;
    World world(scene);
    advance(world, 1.0);
    // It slips with mu g until it is as fast as its surface, 1 m/s, and stays so.
    const double slips = 1.0 / (0.25 * kGravity);
    EXPECT_NEAR(stateOf(world, "ball").twist.v_WB.x(), 1.0, 1e-9) << fidelityName(fidelity);
    EXPECT_NEAR(stateOf(world, "ball").pose.p_WB.x(), 1.0 - 0.5 * slips, 1e-8) << fidelityName(fidelity);
    EXPECT_EQ(stateOf(world, "ball").twist.w_WB.y(), 10.0);
  }
}

// They are printed by terminals of any locale, and logged.
TEST(Detection, ReasonsAreWrittenInPlainLetters) {
  SceneDef scene = twoBalls();
  for (const Need& need : needs()) need.ask(scene);
  const World asked(scene);
  for (const StageInfo& row : asked.pipeline())
    for (const char letter : row.reason) EXPECT_TRUE(letter >= ' ' && letter <= '~') << row.reason;
  scene.gravity.x() = scene.air->density = scene.fluid->density = std::nan("");
  for (BodyDef& def : scene.bodies) def.density = -1.0;
  for (const Problem& problem : validate(scene))
    for (const char letter : problem.path + problem.value + problem.allowed)
      EXPECT_TRUE(letter >= ' ' && letter <= '~') << problem.path << ' ' << problem.allowed;
}

TEST(Detection, MasksDecideWhoMayMeet) {
  SceneDef scene = twoBalls();
  EXPECT_EQ(stage(World(scene), "broadphase.pairs").reason, "2 bodies may meet another: 2 spheres");
  scene.bodies[0].group = 2;
  scene.bodies[1].mask = 1;
  const World world(scene);
  EXPECT_FALSE(stage(world, "broadphase.pairs").active);
  EXPECT_TRUE(stage(world, "ballistic.integrate").active);
}

// --- orientations that nobody carries along

TEST(Attitude, OfABallWithoutFrictionIsEvaluatedWhenItIsRead) {
  SceneDef scene = twoBalls();
  World world(scene);
  EXPECT_FALSE(stage(world, "rotation.integrate").active);
  const Vec3 w(0.3, -0.2, 0.7);
  for (int k = 0; k < 120; ++k) {
    world.step();
    EXPECT_EQ(stateOf(world, "left").twist.w_WB, w);
    EXPECT_LE(stateOf(world, "left").pose.q_WB.angularDistance(rotationBy(world.time() * w)), 1e-14);
  }
}

TEST(Attitude, SurvivesSavingBitForBit) {
  World world(twoBalls());
  advance(world, 0.3);
  const SceneFile file = parseScene(writeScene(world.capture(), world.captureState()), "saved.yaml");
  World restored(file.scene, file.state);
  EXPECT_EQ(restored.stateHash(), world.stateHash());
  for (int k = 0; k < 100; ++k) {
    world.step(), restored.step();
    EXPECT_EQ(restored.stateHash(), world.stateHash());
    EXPECT_EQ(stateOf(restored, "left").pose.q_WB.coeffs(), stateOf(world, "left").pose.q_WB.coeffs());
  }
}

// --- switching in mid-run

TEST(Switching, MakesNoJumpInTheStateOfAnyBody) {
  using Edit = std::function<void(World&)>;
  const std::vector<std::pair<std::string, Edit>> edits{
      {"friction",
       [](World& w) {
         BodyEdit e;
         e.friction = 0.4;
         w.editBody(w.find("left"), e);
         w.editBody(w.find("right"), e);
       }},
      {"a box",
       [](World& w) {
         w.addBody(box("new", {0.2, 0.3, 0.4}, {0.0, 5.0, 0.0}));
       }},
      {"wind",
       [](World& w) {
         w.setAir(Air{});
         w.setWind(Wind{});
       }},
      {"a fluid", [](World& w) { w.setFluid(Fluid{}); }},
      {"gravity",
       [](World& w) {
         w.setGravity({0.0, 0.0, -9.81});
       }},
      {"a hand", [](World& w) { w.grab(w.find("left"), Grab{}); }},
      {"a wrench",
       [](World& w) {
         w.applyWrench(w.find("left"), {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, 1.0);
       }},
      {"a size",
       [](World& w) {
         BodyEdit e;
         e.shape = Sphere{0.2};
         w.editBody(w.find("left"), e);
       }},
      {"effects on",
       [](World& w) {
         EffectOverrides all;
         for (const Effect e : kEffects) all[e] = true;
         w.setEffects(all);
       }},
      {"effects off",
       [](World& w) {
         EffectOverrides all;
         for (const Effect e : kEffects) all[e] = false;
         w.setEffects(all);
       }},
  };
  for (const Fidelity fidelity : kFidelities) {
    for (const auto& [name, edit] : edits) {
      SceneDef scene = twoBalls();
      scene.fidelity = fidelity;
      World world(scene);
      advance(world, 0.5);
      const BodyState left = stateOf(world, "left"), right = stateOf(world, "right");
      edit(world);
      for (const auto& [before, now] :
           {std::pair(left, stateOf(world, "left")), std::pair(right, stateOf(world, "right"))}) {
        EXPECT_EQ(before.pose.p_WB, now.pose.p_WB) << name;
        EXPECT_EQ(before.pose.q_WB.coeffs(), now.pose.q_WB.coeffs()) << name;
        EXPECT_EQ(before.twist.v_WB, now.twist.v_WB) << name;
        EXPECT_EQ(before.twist.w_WB, now.twist.w_WB) << name;
      }
      // And it goes on from there: in a step it moves by no more than its speed and what pulls at it allow.
      world.step();
      EXPECT_LE((stateOf(world, "left").pose.p_WB - left.pose.p_WB).norm(), 0.2) << name;
      EXPECT_LE(stateOf(world, "left").pose.q_WB.angularDistance(left.pose.q_WB), 0.1) << name;
    }
  }
}

// --- what costs nothing

TEST(Ballistic, AWorldOfBodiesThatMeetNobodyRunsTwoStagesAndAllocatesNothing) {
  SceneDef scene;
  for (int k = 0; k < 100; ++k) {
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.1, {0.3 * k, 0.0, 5.0}));
    scene.bodies.back().mask = 0;
  }
  World world(scene);
  std::vector<std::string> active;
  for (const StageInfo& row : world.pipeline())
    if (row.active) active.push_back(row.name);
  EXPECT_THAT(active, ::testing::ElementsAre("forces.gravity", "ballistic.integrate"));
  world.step();
  const std::size_t before = allocations;
  for (int k = 0; k < 100; ++k) world.step();
  EXPECT_EQ(allocations, before);
}

TEST(Ballistic, IsAParabolaToTheLastDigits) {
  SceneDef scene;
  scene.bodies.push_back(ball("ball", 0.1, {0.0, 0.0, 5.0}));
  scene.bodies.back().twist = {{1.0, 2.0, 3.0}, {0.0, 0.0, 4.0}};
  World world(scene);
  advance(world, 10.0);
  const BodyState state = stateOf(world, "ball");
  EXPECT_LE((state.pose.p_WB - Vec3(10.0, 20.0, 5.0 + 30.0 - 0.5 * kGravity * 100.0)).norm(), 1e-10);
  EXPECT_LE(state.pose.q_WB.angularDistance(rotationBy({0.0, 0.0, 40.0})), 1e-12);
}

// A plate spins a fifth faster as it tumbles.
TEST(Ballistic, ABodyThatTumblesStaysWithinTheLimitOnSpin) {
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(box("plate", {1.0, 0.5, 0.01}, Vec3::Zero()));
  scene.bodies.back().twist.w_WB = {2e5, 9.3e5, 2e5};
  World world(scene);
  std::size_t warnings = 0;
  for (int k = 0; k < 60; ++k) {
    warnings += world.step().warnings.size();
    EXPECT_LE(stateOf(world, "plate").twist.w_WB.norm(), Limits::max_spin);
    EXPECT_NO_THROW(World(world.capture(), world.captureState()));
  }
  EXPECT_GT(warnings, 0u);
}

TEST(Ballistic, ABodyThatLeavesAllBoundsIsFrozenWhereItLastWas) {
  SceneDef scene = emptySpace(1.0);
  scene.bodies.push_back(ball("far", 0.1, {Limits::max_position - 2.5e6, 0.0, 0.0}));
  scene.bodies.back().twist.v_WB.x() = 1e6;
  World world(scene);
  world.step();
  world.step();
  EXPECT_FALSE((*world.snapshot().bodies)[0].frozen);
  const Vec3 last = stateOf(world, "far").pose.p_WB;
  EXPECT_EQ(world.step().warnings.size(), 1u);
  EXPECT_TRUE((*world.snapshot().bodies)[0].frozen);
  world.step();
  EXPECT_EQ(stateOf(world, "far").pose.p_WB, last);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Edits of a world: what they do, and that a bad one changes nothing.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

SceneDef crateAndBall() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  scene.bodies.push_back(box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  scene.bodies.push_back(ball("ball", 0.5, Vec3(3.0, 0.0, 5.0)));
  return scene;
}

// Boxes that fall on each other at a slant, with one that a user force pulls.
World inMotion() {
  World world(crateAndBall());
  BodyDef slanted = box("slanted", Vec3(0.4, 0.6, 0.2), Vec3(0.3, 0.1, 1.6));
  slanted.pose.q_WB = Quat(Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, 0.5).normalized()));
  world.addBody(slanted);
  Grab grab;
  grab.p_W = {3.0, 1.0, 4.0};
  world.grab(world.find("ball"), grab);
  world.applyWrench(world.find("crate"), Vec3(100.0, 0.0, 0.0), Vec3::Zero(), Vec3::Zero(), 0.7);
  return world;
}

// A cube that nothing can turn keeps no orientation up to date: it is asked for where it is needed.
TEST(World, AFreePlaceIsAboveACubeAsItIsTurnedNow) {
  SceneDef scene = emptySpace(1.0 / 100.0);
  scene.bodies = {box("cube", Vec3(2.0, 2.0, 2.0), Vec3::Zero())};
  scene.bodies[0].twist.w_WB = Vec3(0.0, kPi / 4.0, 0.0);
  World world(scene);
  advance(world, 1.0);  // now it stands on an edge
  EXPECT_GT(world.freePlace(Sphere{0.5}, Quat::Identity()).z(), std::sqrt(2.0) + 0.5);
}

TEST(WorldCopy, HasTheSameFutureAndNoPartInThatOfTheOther) {
  for (const Fidelity fidelity : kFidelities) {
    World world = inMotion();
    world.setFidelity(fidelity);
    advance(world, 0.5);
    World copy(world);
    const std::uint64_t then = copy.stateHash();
    EXPECT_EQ(world.stateHash(), then);
    advance(world, 0.5);
    EXPECT_EQ(copy.stateHash(), then) << "the copy moved along";
    EXPECT_NE(world.stateHash(), then);
    advance(copy, 0.5);
    EXPECT_EQ(copy.stateHash(), world.stateHash()) << fidelityName(fidelity);
  }
}

TEST(Divisions, AreStepsOfAPartOfTheStep) {
  constexpr double kStep = 1.0 / 64.0;
  for (const Fidelity fidelity : kFidelities) {
    SceneDef whole = inMotion().capture(), part = whole;
    whole.step = kStep, part.step = kStep / 4.0;
    whole.fidelity = part.fidelity = fidelity;
    whole.fidelity.divisions = 4;
    World divided(whole), fine(part);
    std::uint32_t impacts = 0, impacts_of_parts = 0;
    for (int k = 0; k < 32; ++k) {
      impacts += divided.step().impacts;
      for (int part = 0; part < 4; ++part) impacts_of_parts += fine.step().impacts;
    }
    EXPECT_EQ(divided.time(), fine.time());
    EXPECT_EQ(divided.steps(), 32u);
    EXPECT_EQ(impacts, impacts_of_parts);
    for (const char* name : {"crate", "ball", "slanted"}) {
      EXPECT_EQ(stateOf(divided, name).pose.p_WB, stateOf(fine, name).pose.p_WB) << fidelityName(fidelity);
      EXPECT_EQ(stateOf(divided, name).twist.w_WB, stateOf(fine, name).twist.w_WB) << fidelityName(fidelity);
    }
  }
}

TEST(SubSteps, MakeTheSoftStepStiffer) {
  double sag_before = 1.0;
  for (const std::uint32_t sub_steps : {2, 4, 8, 16}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.6);
    scene.bodies.push_back(box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
    scene.fidelity = Fidelity::Preview;
    scene.fidelity.sub_steps = sub_steps;
    World world(scene);
    advance(world, 2.0);
    const double sag = 0.5 - stateOf(world, "crate").pose.p_WB.z();
    // Sag goes with the square of the time between two sub-steps.
    if (sub_steps > 2) {
      EXPECT_NEAR(sag_before / sag, 4.0, 0.4) << sub_steps;
    }
    sag_before = sag;
  }
}

TEST(Tolerance, IsWhatTheExactStepStopsAt) {
  double residual_before = 0.0;
  for (const double tolerance : {1e-12, 1e-3}) {
    World world = inMotion();
    Setting setting(Fidelity::Accurate);
    setting.tolerance = tolerance;
    world.setFidelity(setting);
    double worst = 0.0;
    for (int k = 0; k < 60; ++k)
      for (const IslandResiduals& island : world.step().residuals)
        worst = std::max({worst, island.signorini, island.coulomb, island.dissipation});
    EXPECT_GT(worst, residual_before);
    EXPECT_LT(worst, 100.0 * tolerance);
    residual_before = 100.0 * tolerance;
  }
}

// Boxes that fall in a heap.
World heap(std::optional<double> max_solve_ms) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.6);
  for (int k = 0; k < 12; ++k) {
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3(0.5, 0.4, 0.3),
                               Vec3(0.1 * (k % 3), 0.07 * (k % 4), 0.5 + 0.7 * k)));
    scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(0.3 * k, Vec3(1.0, k, 0.5).normalized()));
  }
  scene.fidelity = Fidelity::Accurate;
  scene.fidelity.max_solve_ms = max_solve_ms;
  return World(scene);
}

TEST(TimeForSolves, EndsThemWithTheBestTheyHaveAndSaysSo) {
  std::uint64_t iterations[2] = {0, 0};
  for (const bool limited : {false, true}) {
    World world = heap(limited ? std::optional<double>(1e-6) : std::nullopt);
    int unsolved = 0;
    double deepest = 0.0, worst = 0.0;
    for (int k = 0; k < 120; ++k) {
      const StepReport& report = world.step();
      deepest = std::max(deepest, report.deepest_penetration);
      for (const IslandResiduals& island : report.residuals) {
        unsolved += !island.converged;
        iterations[limited] += island.iterations;
        if (!island.converged)
          worst = std::max({worst, island.signorini, island.coulomb, island.dissipation});
      }
    }
    EXPECT_EQ(unsolved > 0, limited);
    EXPECT_EQ(worst > 1e-6, limited) << "the residuals of solves that were cut short are reported";
    EXPECT_LT(deepest, 0.15) << "nothing falls through";
    EXPECT_LT(energy(world), 1e6);
  }
  EXPECT_LT(iterations[1], iterations[0] / 2) << "solves that begin at their solution need no time";
}

TEST(Settings, FaultyOnesAreRefusedAndChangeNothing) {
  World world = inMotion();
  const std::uint64_t before = world.stateHash();
  Setting divisions, sub_steps, tolerance, number, time;
  time.max_solve_ms = 0.0;
  divisions.divisions = 0;
  sub_steps.sub_steps = 1001;
  tolerance.tolerance = 0.0;
  number.tolerance = kNaN;
  for (const Setting& setting : {divisions, sub_steps, tolerance, number, time})
    EXPECT_THROW(world.setFidelity(setting), InvalidInput);
  for (const Goal& goal :
       {Goal{}, Goal{1.0, 1.0}, Goal{-1.0, {}}, Goal{{}, kNaN}, Goal{kInfinite, {}}, Goal{{}, 0.0}})
    EXPECT_THROW(world.setGoal(goal), InvalidInput);
  EXPECT_EQ(world.stateHash(), before);
  EXPECT_FALSE(world.scene().goal);
}

TEST(WorldEdits, AHandleIsNeverUsedAgain) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate");
  world.removeBody(crate);
  EXPECT_FALSE(world.find("crate"));
  const BodyId again = world.addBody(box("crate", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  EXPECT_NE(again, crate);
  EXPECT_THROW(world.removeBody(crate), InvalidInput);
}

// The name follows from those that are there: so a world that is saved and restored goes on alike.
TEST(WorldEdits, AnUnnamedBodyIsNamedAlikeInARestoredWorld) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  World world(scene);
  const auto addUnnamed = [](World& to, double x) {
    BodyDef def = ball("", 0.1, {x, 0.0, 1.0});
    to.addBody(def);
    return to.capture().bodies.back().name;
  };
  EXPECT_EQ(addUnnamed(world, 0.0), "sphere_1");
  EXPECT_EQ(addUnnamed(world, 1.0), "sphere_2");
  EXPECT_EQ(addUnnamed(world, 2.0), "sphere_3");
  world.addBody(ball("sphere_5", 0.1, {3.0, 0.0, 1.0}));
  world.removeBody(world.find("sphere_2"));
  BodyEdit edit;
  edit.name = "moved";
  world.editBody(world.find("sphere_1"), edit);
  World copy(world);
  World restored(world.capture(), world.captureState());
  for (int k = 0; k < 5; ++k) {
    const std::string name = addUnnamed(world, 4.0 + k);
    EXPECT_EQ(addUnnamed(restored, 4.0 + k), name);
    EXPECT_EQ(addUnnamed(copy, 4.0 + k), name);
    world.step(), restored.step(), copy.step();
    EXPECT_EQ(restored.stateHash(), world.stateHash());
    EXPECT_EQ(copy.stateHash(), world.stateHash());
  }
  EXPECT_TRUE(world.find("sphere_7"));
  EXPECT_FALSE(world.find("sphere_8"));
}

TEST(WorldEdits, ARemovedBodyTakesItsContactsAlong) {
  SceneDef scene = crateAndBall();
  scene.bodies.push_back(box("plank", Vec3(2.0, 0.6, 0.2), Vec3(0.1, 0.0, 1.1)));
  World world(scene);
  for (int k = 0; k < 40; ++k) world.step();
  const BodyId crate = world.find("crate");
  const auto touches = [&](const ContactPoint& c) { return c.a == crate || c.b == crate; };
  const auto before = world.snapshot().contacts;
  ASSERT_TRUE(std::any_of(before.begin(), before.end(), touches));
  world.removeBody(crate);
  const auto after = world.snapshot().contacts;
  EXPECT_TRUE(std::none_of(after.begin(), after.end(), touches));
  EXPECT_EQ(World(world.capture(), world.captureState()).stateHash(), world.stateHash());
}

TEST(WorldEdits, MassFollowsDensityAndDensityFollowsMass) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate");
  const auto now = [&] { return (*world.snapshot().bodies)[1]; };
  EXPECT_DOUBLE_EQ(now().mass, 1000.0);
  BodyEdit mass;
  mass.mass = 50.0;
  world.editBody(crate, mass);
  EXPECT_DOUBLE_EQ(now().density, 50.0);
  BodyEdit shape;
  shape.shape = Box{Vec3(2.0, 1.0, 1.0)};
  world.editBody(crate, shape);
  EXPECT_DOUBLE_EQ(now().mass, 100.0);
  EXPECT_LE((now().inertia - 100.0 / 12.0 * Vec3(2.0, 5.0, 5.0)).norm(), 1e-12);
}

TEST(WorldEdits, ABodyIsRenamedAndStaysTheSame) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate");
  for (int k = 0; k < 30; ++k) world.step();
  World other(world);
  BodyEdit edit;
  edit.name = "chest";
  world.editBody(crate, edit);
  EXPECT_EQ(world.find("chest"), crate);
  EXPECT_FALSE(world.find("crate"));
  EXPECT_EQ((*world.bodies())[1].name, "chest");
  edit.name = "ball";
  EXPECT_THROW(world.editBody(crate, edit), InvalidInput);
  edit.name = "";
  EXPECT_THROW(world.editBody(crate, edit), InvalidInput);
  edit.name = "a//b";
  EXPECT_THROW(world.editBody(crate, edit), InvalidInput);
  edit.name = "chest";
  world.editBody(crate, edit);  // its own name
  edit.name = "crate";
  world.editBody(crate, edit);
  other.editBody(crate, edit);
  for (int k = 0; k < 30; ++k) {
    world.step();
    other.step();
  }
  EXPECT_EQ(world.stateHash(), other.stateHash());
}

TEST(WorldEdits, AnImpulseGivesMomentumAndSpinByItsLever) {
  World world(crateAndBall());
  const Totals before = world.totals();
  const Vec3 impulse(10.0, 20.0, 30.0), point(3.2, 0.1, 5.0);
  world.applyImpulse(world.find("ball"), impulse, point);
  EXPECT_LE((world.totals().momentum - before.momentum - impulse).norm(), 1e-12);
  EXPECT_LE((world.totals().angular_momentum - before.angular_momentum - point.cross(impulse)).norm(), 1e-11);
}

TEST(WorldEdits, AGrabbedBodyComesToTheHandAndKeepsItsVelocityWhenLetGo) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate");
  Grab grab;
  grab.p_W = {0.0, 0.0, 3.0};
  world.grab(crate, grab);
  advance(world, 3.0);
  EXPECT_NEAR(stateOf(world, "crate").pose.p_WB.z(), 3.0, 0.05);
  grab.p_W = {10.0, 0.0, 3.0};
  world.grab(crate, grab);
  advance(world, 0.1);
  const Vec3 thrown = stateOf(world, "crate").twist.v_WB;
  EXPECT_GT(thrown.x(), 1.0);
  world.release(crate);
  EXPECT_EQ(stateOf(world, "crate").twist.v_WB, thrown);
}

TEST(WorldEdits, AHeldBodyIsLedThereAndIsAtRestWhenLetGo) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate");
  world.hold(crate, {Vec3(2.0, 0.0, 4.0), Quat::Identity()});
  advance(world, 1.0);
  EXPECT_LE((stateOf(world, "crate").pose.p_WB - Vec3(2.0, 0.0, 4.0)).norm(), 1e-9);
  world.release(crate);
  EXPECT_EQ(stateOf(world, "crate").twist.v_WB.norm(), 0.0);
}

TEST(WorldEdits, WhatASceneDoesNotNeedDoesNotRun) {
  const auto active = [](const World& world, const std::string& name) {
    for (const StageInfo& stage : world.pipeline())
      if (stage.name == name) return stage.active;
    throw std::out_of_range(name);
  };
  SceneDef scene = emptySpace(1.0 / 60.0);
  scene.bodies.push_back(ball("ball", 0.5, Vec3::Zero()));
  World world(scene);
  for (const char* stage : {"forces.gravity", "forces.drag", "forces.wrench", "user_force.spring",
                            "user_force.drag", "broadphase.pairs", "impacts.predict", "narrowphase.collide",
                            "contacts.friction", "rotation.gyroscopic"}) {
    EXPECT_FALSE(active(world, stage)) << stage;
  }
  world.setGravity({0.0, 0.0, -1.0});
  EXPECT_TRUE(active(world, "forces.gravity"));
  world.setAir(Air{});
  EXPECT_TRUE(active(world, "forces.drag"));
  world.setAir(std::nullopt);
  EXPECT_FALSE(active(world, "forces.drag"));
  world.addBody(box("plank", Vec3(3.0, 2.0, 1.0), Vec3(5.0, 0.0, 0.0)));
  EXPECT_TRUE(active(world, "broadphase.pairs"));
  EXPECT_TRUE(active(world, "rotation.gyroscopic"));
}

TEST(WorldEdits, ABadEditSaysWhereAndChangesNothing) {
  World world(crateAndBall());
  const BodyId crate = world.find("crate"), ball_id = world.find("ball"), floor = world.find("floor");
  const auto edit = [&](auto set) {
    return [&world, crate, set] {
      BodyEdit e;
      set(e);
      world.editBody(crate, e);
    };
  };
  struct Bad {
    const char* word;
    std::function<void()> act;
  };
  const Bad cases[] = {
      {"mass", edit([](BodyEdit& e) { e.mass = -1.0; })},
      {"mass", edit([](BodyEdit& e) { e.mass = kNaN; })},
      {"mass", edit([](BodyEdit& e) { e.mass = 0.0; })},
      {"density", edit([](BodyEdit& e) { e.density = kInfinite; })},
      {"friction", edit([](BodyEdit& e) { e.friction = -0.5; })},
      {"restitution", edit([](BodyEdit& e) { e.restitution = 1.01; })},
      {"drag", edit([](BodyEdit& e) { e.drag_coefficient = kNaN; })},
      {"size", edit([](BodyEdit& e) { e.shape = Box{Vec3(1.0, 0.0, 1.0)}; })},
      {"position", edit([](BodyEdit& e) {
         e.pose = Pose{Vec3(kNaN, 0.0, 0.0), Quat::Identity()};
       })},
      {"orientation", edit([](BodyEdit& e) {
         e.pose = Pose{Vec3::Zero(), Quat(0.0, 0.0, 0.0, 0.0)};
       })},
      {"velocity", edit([](BodyEdit& e) {
         e.twist = Twist{Vec3(1e9, 0.0, 0.0), Vec3::Zero()};
       })},
      {"density", edit([](BodyEdit& e) { e.mass = 1.0, e.density = 1.0; })},
      {"name", [&] { world.addBody(ball("crate", 0.5, Vec3::Zero())); }},
      {"name", [&] { world.addBody(ball("no good", 0.5, Vec3::Zero())); }},
      {"bodies[1]",
       [&] {
         world.addBodies({ball("fine", 0.5, Vec3::Zero()), ball("bad", -0.5, Vec3::Zero())});
       }},
      {"impulse", [&] { world.applyImpulse(ball_id, Vec3(kNaN, 0.0, 0.0), Vec3::Zero()); }},
      {"impulse",
       [&] {
         const double mass = (*world.bodies())[world.snapshot().find(ball_id)].mass;
         world.applyImpulse(ball_id, 0.9 * Limits::max_speed * mass * Vec3(1.0, 1.0, 0.0),
                            world.pose(ball_id).p_WB);
       }},
      {"hold",
       [&] {
         world.hold(ball_id, Pose{0.9 * Limits::max_position * Vec3(1.0, 1.0, 0.0), Quat::Identity()});
       }},
      {"floor", [&] { world.applyImpulse(floor, Vec3::UnitX(), Vec3::Zero()); }},
      {"seconds", [&] { world.applyWrench(ball_id, Vec3::UnitX(), Vec3::Zero(), Vec3::Zero(), 0.0); }},
      {"gravity", [&] { world.setGravity(Vec3(0.0, 0.0, kInfinite)); }},
      {"density", [&] { world.setAir(Air{-1.0}); }},
      {"air", [&] { world.setWind(Wind{}); }},
      {"", [&] { world.removeBody(BodyId{999}); }},
      {"", [&] { world.grab(floor, Grab{}); }},
  };
  const std::uint64_t before = world.stateHash();
  for (const Bad& bad : cases) {
    try {
      bad.act();
      ADD_FAILURE() << "not refused: " << bad.word << " #" << &bad - cases;
    } catch (const InvalidInput& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(bad.word), std::string::npos) << refusal.what();
      EXPECT_NE(std::string(refusal.what()).size(), 0u);
    }
    EXPECT_EQ(world.stateHash(), before) << bad.word;
  }
}

TEST(WorldEdits, TheHashSeesEveryPartOfTheState) {
  const World reference(crateAndBall());
  const std::function<void(SceneDef&)> changes[] = {
      [](SceneDef& s) { s.bodies[1].pose.p_WB.x() += 1e-15; },
      [](SceneDef& s) { s.bodies[2].twist.w_WB.y() = 1e-300; },
      [](SceneDef& s) { s.bodies[1].material.friction = 0.61; },
      [](SceneDef& s) { s.bodies[1].density = 1001.0; },
      [](SceneDef& s) { s.bodies[2].shape = Sphere{0.51}; },
      [](SceneDef& s) { s.bodies[2].kind = BodyKind::Static; },
      [](SceneDef& s) { s.gravity.z() = -9.8; },
      [](SceneDef& s) { s.air = Air{}; },
      [](SceneDef& s) { s.step = 0.01; },
      [](SceneDef& s) { s.seed = 2; },
      [](SceneDef& s) { s.fidelity = Fidelity::Preview; },
      [](SceneDef& s) { s.bodies[2].mask = 0; },
  };
  for (const auto& change : changes) {
    SceneDef scene = crateAndBall();
    change(scene);
    EXPECT_NE(World(scene).stateHash(), reference.stateHash()) << &change - changes;
  }
  EXPECT_EQ(World(crateAndBall()).stateHash(), reference.stateHash());
}

}  // namespace

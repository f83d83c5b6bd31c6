// SPDX-License-Identifier: BSD-3-Clause
// Undo and redo: every edit back and forth to the same state hash, across loads, with time in between.
#include "rigid_body_sim/simulator.h"

#include "make_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace rbs::test {
namespace {

using testing::HasSubstr;

SceneDef twoBoxes() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.name = "two_boxes";
  scene.bodies.push_back(box("low", {1.0, 1.0, 1.0}, {0.0, 0.0, 0.5}));
  scene.bodies.push_back(box("high", {1.0, 1.0, 1.0}, {0.1, 0.0, 1.5}));
  return scene;
}

Simulator::Options paused() {
  Simulator::Options options;
  options.paused = true;
  return options;
}

std::uint64_t hashOf(const Simulator& simulator) {
  return simulator.snapshot()->hash;
}

void spawn(Simulator& simulator, const std::string& name, double z = 5.0) {
  simulator.apply([&](World& world) {
    world.addBody(ball(name, 0.2, {0.0, 0.0, z}));
    return "spawned " + name;
  });
}

// One edit of any kind.
void editAnything(Simulator& simulator, std::mt19937& random, int k) {
  simulator.apply([&](World& world) -> std::string {
    const auto bodies = world.bodies();
    const BodyDescription& body = (*bodies)[random() % bodies->size()];
    BodyEdit edit;
    switch (random() % 7) {
      case 0:
        world.addBody(ball("ball_" + std::to_string(k), 0.1, {0.3 * (k % 7), 0.3 * (k % 5), 4.0 + 0.3 * k}));
        return "spawned";
      case 1:
        if (bodies->size() > 3) return world.removeBody(body.id), "deleted";
        return "nothing";
      case 2:
        edit.pose = Pose{Vec3(0.01 * k, 0.0, 3.0), Quat::Identity()};
        return world.editBody(body.id, edit), "moved";
      case 3:
        edit.friction = 0.1 * (k % 9);
        return world.editBody(body.id, edit), "changed";
      case 4:
        return world.setGravity({0.0, 0.0, -1.0 - k % 10}), "gravity";
      case 5:
        world.setAir(Air{});
        return world.setWind(Wind{{0.1 * k, 0.0, 0.0}, 0.0}), "wind";
      default:
        return world.clear(), world.addBody(ball("rest_" + std::to_string(k), 0.1, {0.0, 0.0, 1.0})),
               "cleared";
    }
  });
}

TEST(Undo, GoesBackThroughAThousandEditsToTheSameHashes) {
  Simulator simulator(twoBoxes(), paused());
  std::mt19937 random(3);
  std::vector<std::uint64_t> before, after;
  for (int k = 0; k < 1000; ++k) {
    const std::uint64_t edits = simulator.snapshot()->revision, hash = hashOf(simulator);
    editAnything(simulator, random, k);
    if (simulator.snapshot()->revision != edits) before.push_back(hash), after.push_back(hashOf(simulator));
    if (k % 10 == 0) simulator.step(3);
  }
  ASSERT_GT(before.size(), 800u);
  std::vector<std::uint64_t> left;  // by each undo
  for (std::size_t k = before.size(); k-- > 0;) {
    left.push_back(hashOf(simulator));
    simulator.undo();
    ASSERT_EQ(hashOf(simulator), before[k]) << k;
  }
  EXPECT_EQ(simulator.snapshot()->undo, "");
  EXPECT_THROW(simulator.undo(), InvalidInput);
  for (std::size_t k = 0; k < before.size(); ++k) {
    simulator.redo();
    ASSERT_EQ(hashOf(simulator), left[before.size() - 1 - k]) << k;
  }
  EXPECT_THROW(simulator.redo(), InvalidInput);
}

TEST(Undo, GoesBackInTimeAndOnAlike) {
  Simulator simulator(twoBoxes(), paused());
  simulator.step(30);
  const auto before = simulator.snapshot();
  spawn(simulator, "new");
  simulator.step(50);
  const auto later = simulator.snapshot();
  EXPECT_EQ(later->undo, "spawned new");
  EXPECT_EQ(simulator.undo(), "spawned new");
  const auto undone = simulator.snapshot();
  EXPECT_EQ(undone->hash, before->hash);
  EXPECT_EQ(undone->time, before->time);
  EXPECT_GE(undone->elapsed, later->elapsed) << "clocks never go back";
  EXPECT_GT(undone->edits, later->edits);
  EXPECT_NE(undone->world, later->world);
  EXPECT_EQ(undone->redo, "spawned new");
  simulator.step(50);
  EXPECT_EQ(simulator.redo(), "spawned new");
  EXPECT_EQ(hashOf(simulator), later->hash);
  simulator.undo();
  spawn(simulator, "other");
  EXPECT_EQ(simulator.snapshot()->redo, "") << "a new edit ends what can be redone";
}

TEST(Undo, BringsBackAnEarlierSceneAndItsReset) {
  Simulator simulator(twoBoxes(), paused());
  spawn(simulator, "mine");
  simulator.step(10);
  const auto before = simulator.snapshot();
  SceneDef other;
  other.name = "other";
  other.air = Air{};
  simulator.load(other);
  EXPECT_TRUE(simulator.loaded()->air);
  EXPECT_EQ(simulator.undo(), "loaded 'other'");
  EXPECT_EQ(simulator.snapshot()->hash, before->hash);
  EXPECT_EQ(simulator.snapshot()->scene, "two_boxes");
  EXPECT_FALSE(simulator.loaded()->air);
  simulator.reset();
  EXPECT_EQ(simulator.snapshot()->bodies->size(), 3u);
  EXPECT_EQ(simulator.undo(), "reset 'two_boxes'");
  EXPECT_EQ(simulator.snapshot()->hash, before->hash);
}

TEST(Undo, KeepsThePaceAndTheSolverSettings) {
  Simulator simulator(twoBoxes(), paused());
  simulator.setSpeed(2.0);
  spawn(simulator, "new");
  simulator.edit([](World& world) { world.setFidelity(Fidelity::Reference); });
  simulator.undo();
  EXPECT_EQ(simulator.snapshot()->fidelity, Setting(Fidelity::Reference));
  EXPECT_TRUE(simulator.pace().paused);
  EXPECT_EQ(simulator.pace().requested_speed, 2.0);
}

// The hand that held a body then holds another one, or none.
// A reset takes the settings of the scene: they belong to what it undoes.
TEST(Undo, OfAResetBringsTheSolverSettingsBackToo) {
  Simulator simulator(twoBoxes(), paused());
  simulator.edit([](World& world) {
    world.setFidelity(Fidelity::Accurate);
    Goal goal;
    goal.max_step_ms = 5.0;
    world.setGoal(goal);
  });
  const std::uint64_t before = hashOf(simulator);
  simulator.reset();
  EXPECT_EQ(simulator.snapshot()->fidelity.preset, SceneDef{}.fidelity.preset);
  simulator.undo();
  EXPECT_EQ(hashOf(simulator), before);
  EXPECT_EQ(simulator.snapshot()->fidelity.preset, Fidelity::Accurate);
  EXPECT_TRUE(simulator.snapshot()->goal.has_value());
  simulator.redo();
  EXPECT_EQ(simulator.snapshot()->fidelity.preset, SceneDef{}.fidelity.preset);
}

TEST(Undo, LetsGoOfWhatIsHeld) {
  for (const bool by_spring : {true, false}) {
    Simulator simulator(twoBoxes(), paused());
    simulator.edit([&](World& world) {
      const BodyId high = world.find("high");
      if (by_spring) {
        Grab grab;
        grab.p_W = Vec3(0.1, 0.0, 2.0);
        world.grab(high, grab);
      } else {
        world.hold(high, {Vec3(0.1, 0.0, 2.0), Quat::Identity()});
      }
    });
    simulator.step(1);
    spawn(simulator, "new", 20.0);
    simulator.step(1);
    simulator.undo();
    simulator.step(120);
    const auto undone = simulator.snapshot();
    EXPECT_NEAR(undone->states[undone->find("high")].pose.p_WB.z(), 1.5, 1e-3) << "it has fallen back";
    simulator.redo();
    simulator.step(120);
    const auto redone = simulator.snapshot();
    EXPECT_NEAR(redone->states[redone->find("high")].pose.p_WB.z(), 1.5, 1e-3);
  }
}

TEST(Undo, TellsWhatNoFileHolds) {
  Simulator simulator(twoBoxes(), paused());
  EXPECT_FALSE(simulator.snapshot()->unsaved);
  spawn(simulator, "a");
  EXPECT_TRUE(simulator.snapshot()->unsaved);
  simulator.markSaved(simulator.snapshot()->revision);
  simulator.step(1);
  EXPECT_FALSE(simulator.snapshot()->unsaved) << "time is no edit";
  spawn(simulator, "b");
  EXPECT_TRUE(simulator.snapshot()->unsaved);
  simulator.undo();
  EXPECT_FALSE(simulator.snapshot()->unsaved);
  simulator.redo();
  EXPECT_TRUE(simulator.snapshot()->unsaved);
  simulator.reset();
  EXPECT_FALSE(simulator.snapshot()->unsaved);
}

TEST(Undo, AnEditThatFailsLeavesTheSettingsAsTheyWere) {
  Simulator simulator(twoBoxes(), paused());
  const Fidelity before = simulator.snapshot()->fidelity.preset;
  const Fidelity other = before == Fidelity::Preview ? Fidelity::Accurate : Fidelity::Preview;
  EXPECT_THROW(simulator.apply([&](World& world) -> std::string {
    world.setFidelity(other);
    world.removeBody(BodyId{99});
    return "dial";
  }),
               InvalidInput);
  EXPECT_EQ(simulator.snapshot()->fidelity.preset, before);
}

TEST(Undo, DoesNotCountWhatChangesNothing) {
  Simulator simulator(twoBoxes(), paused());
  EXPECT_THROW(simulator.apply([](World& world) -> std::string {
    world.addBody(ball("low", 0.1, Vec3::Zero()));
    return "spawned";
  }),
               InvalidInput);
  simulator.apply([](World& world) -> std::string { return world.setFidelity(Fidelity::Preview), "dial"; });
  EXPECT_EQ(simulator.snapshot()->undo, "");
  EXPECT_FALSE(simulator.snapshot()->unsaved);
  try {
    simulator.undo();
    FAIL() << "there is nothing to undo";
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("nothing to undo"));
  }
}

// Each setter with what is so already, and then with something else.
TEST(Undo, DoesNotCountAnEditToWhatIsSoAlready) {
  SceneDef scene = twoBoxes();
  scene.bodies[1].twist.w_WB = {0.0, 0.0, 0.1};
  scene.air = Air{};
  scene.wind = Wind{{3.0, 0.0, 0.0}, 1.0};
  scene.fluid = Fluid{};
  scene.effects[Effect::Sleeping] = false;
  Simulator simulator(scene, paused());
  simulator.step(5);
  const BodyDescription body = (*simulator.snapshot()->bodies)[2];
  const BodyState state = simulator.snapshot()->states[2];
  BodyEdit same;
  same.name = body.name;
  same.shape = body.shape;
  same.mass = body.mass;
  same.kind = body.kind;
  same.pose = state.pose;
  same.twist = state.twist;
  same.friction = body.material.friction;
  same.color = body.color;
  same.group = body.group;
  same.mask = body.mask;
  BodyEdit name = same, shape = same, mass = same, kind = same, pose = same, twist = same, friction = same,
           color = same, group = same;
  name.name = "other";
  shape.shape = Box{{0.5, 0.5, 0.6}};
  mass.mass = 2.0 * body.mass;
  kind.kind = BodyKind::Static;
  kind.twist.reset();
  pose.pose->p_WB.x() += 1e-12;
  twist.twist->w_WB.y() += 1e-12;
  friction.friction = 0.1;
  color.color = Color{0.1f, 0.2f, 0.3f, 1.0f};
  group.group = 2;
  using Change = std::function<void(World&)>;
  const auto editsTo = [&](const BodyEdit& edit) -> Change {
    return [&, edit](World& world) { world.editBody(world.find(body.name), edit); };
  };
  struct Case {
    const char* what;
    Change same;
    std::vector<Change> others;
  };
  const auto hashed = [&] { return hashOf(simulator); };
  for (const Case& c :
       {Case{"gravity", [&](World& w) { w.setGravity(scene.gravity); }, {[](World& w) {
               w.setGravity({0.0, 0.0, -9.82});
             }}},
        Case{"air",
             [&](World& w) { w.setAir(Air{}); },
             {[](World& w) { w.setAir(Air{1.3}); }, [](World& w) { w.setAir(std::nullopt); }}},
        Case{"wind",
             [&](World& w) { w.setWind(scene.wind); },
             {[](World& w) {
                w.setWind(Wind{{3.0, 0.0, 0.0}, 0.9});
              },
              [](World& w) {
                w.setWind(Wind{{3.0, 0.1, 0.0}, 1.0});
              },
              [](World& w) { w.setWind(std::nullopt); }}},
        Case{"fluid",
             [&](World& w) { w.setFluid(scene.fluid); },
             {[](World& w) {
                w.setFluid(Fluid{1000.0, 0.1});
              },
              [](World& w) {
                w.setFluid(Fluid{900.0, 0.0});
              }}},
        Case{"effects", [&](World& w) { w.setEffects(scene.effects); }, {[](World& w) { w.setEffects({}); }}},
        Case{"no bodies", [](World& w) { w.addBodies({}); }, {}},
        Case{"body",
             editsTo(same),
             {editsTo(name), editsTo(shape), editsTo(mass), editsTo(kind), editsTo(pose), editsTo(twist),
              editsTo(friction), editsTo(color), editsTo(group)}}}) {
    SCOPED_TRACE(c.what);
    const std::uint64_t before = hashed(), edits = simulator.snapshot()->edits;
    simulator.apply([&](World& world) { return c.same(world), "the same"; });
    EXPECT_EQ(hashed(), before);
    EXPECT_EQ(simulator.snapshot()->edits, edits);
    EXPECT_EQ(simulator.snapshot()->undo, "");
    EXPECT_FALSE(simulator.snapshot()->unsaved);
    for (std::size_t k = 0; k < c.others.size(); ++k) {
      simulator.apply([&](World& world) { return c.others[k](world), "another"; });
      EXPECT_EQ(simulator.snapshot()->undo, "another") << k;
      simulator.undo();
      EXPECT_EQ(hashed(), before);
    }
  }
  simulator.load(SceneDef{});
  simulator.forgetEdits();
  simulator.apply([](World& world) { return world.clear(), "cleared"; });
  EXPECT_EQ(simulator.snapshot()->undo, "");
}

TEST(Undo, AnEditOfSeveralBodiesIsMadeAsAWholeOrNotAtAll) {
  Simulator simulator(twoBoxes(), paused());
  simulator.step(3);
  const auto before = simulator.snapshot();
  EXPECT_THROW(simulator.apply([](World& world) -> std::string {
    world.removeBody(world.find("low"));
    world.addBody(ball("new", 0.1, {0.0, 0.0, 5.0}));
    world.addBody(ball("high", 0.1, Vec3::Zero()));
    return "three edits";
  }),
               InvalidInput);
  EXPECT_EQ(hashOf(simulator), before->hash);
  EXPECT_EQ(simulator.snapshot()->undo, "");
  EXPECT_EQ(simulator.snapshot()->bodies->size(), before->bodies->size());
  simulator.step(3);
  Simulator other(twoBoxes(), paused());
  other.step(6);
  EXPECT_EQ(hashOf(simulator), hashOf(other));
}

int undoAll(Simulator& simulator) {
  int undone = 0;
  for (; !simulator.snapshot()->undo.empty(); ++undone) simulator.undo();
  return undone;
}

void setGravity(Simulator& simulator, double gravity) {
  simulator.apply([&](World& world) -> std::string {
    return world.setGravity({0.0, 0.0, gravity}), "gravity";
  });
}

TEST(Undo, ForgetsTheOldestEdits) {
  Simulator simulator(twoBoxes(), paused());
  for (int k = 1; k <= 1001; ++k) setGravity(simulator, -0.001 * k);
  EXPECT_EQ(undoAll(simulator), 1000);
  try {
    simulator.undo();
    FAIL() << "the first edit is forgotten";
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("edits forgotten: 1"));
  }

  SceneDef many;
  for (int k = 0; k < 1000; ++k)
    many.bodies.push_back(ball("ball_" + std::to_string(k), 0.1, {1.0 * k, 0.0, 0.0}));
  simulator.load(many);
  for (int k = 1; k <= 150; ++k) setGravity(simulator, -0.001 * k);
  EXPECT_EQ(undoAll(simulator), 100) << "of 100,000 bodies in all worlds";
}

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// Commands as data, and recordings: what a simulator did, run again to the same state hashes.
#include "rigid_body_sim/recording.h"
#include "rigid_body_sim/simulator.h"

#include "make_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace rbs::test {
namespace {

using testing::HasSubstr;

/// Random values, with all their bits.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  std::size_t index(std::size_t size) { return random_() % size; }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  double between(double low, double high) { return low + (high - low) * std::ldexp(random_() >> 11, -53); }
  Vec3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size);
    return {x, y, between(-size, size)};
  }
  Quat turn() { return Quat(between(0.5, 1.0), between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)); }
  Pose pose() {
    const Vec3 p = vector(2.0) + Vec3(0.0, 0.0, 4.0);
    return {p, turn()};
  }
  Shape shape() {
    const double size = between(0.1, 0.5);
    switch (index(6)) {
      case 0:
        return Sphere{size};
      case 1:
        return Box{{size, between(0.1, 0.5), between(0.1, 0.5)}};
      case 2:
        return Capsule{size, between(0.1, 0.5)};
      case 3:
        return Cylinder{size, between(0.1, 0.5)};
      case 4:
        return Cone{size, between(0.1, 0.5)};
      default: {
        std::vector<Vec3> points;
        for (int k = 0; k < 12; ++k) points.push_back(vector(size));
        return makeHull(points, "points").hull;
      }
    }
  }
  BodyDef body(const std::string& name) {
    BodyDef def;
    def.name = name;
    def.shape = shape();
    def.pose = pose();
    def.twist = {vector(2.0), vector(2.0)};
    if (chance(0.5)) def.density = between(100.0, 5000.0);
    def.material.friction = between(0.0, 1.0);
    if (chance(0.3)) def.material.restitution = between(0.0, 1.0);
    if (chance(0.3)) def.material.drag_coefficient = between(0.0, 2.0);
    if (chance(0.3)) def.color = Color{0.1f, static_cast<float>(between(0.0, 1.0)), 0.3f, 1.0f};
    return def;
  }
  BodyEdit edit() {
    BodyEdit edit;
    if (chance(0.2)) edit.shape = shape();
    if (chance(0.3)) edit.pose = pose();
    if (chance(0.3)) edit.twist = Twist{vector(2.0), vector(2.0)};
    if (chance(0.2)) edit.mass = between(0.5, 5.0);
    if (!edit.mass && chance(0.2)) edit.density = between(100.0, 5000.0);
    if (chance(0.3)) edit.friction = between(0.0, 1.0);
    if (chance(0.3)) edit.restitution = between(0.0, 1.0);
    if (chance(0.3)) edit.drag_coefficient = between(0.0, 2.0);
    if (chance(0.3)) edit.rolling_resistance = between(0.0, 0.1);
    if (chance(0.3)) edit.torsional_resistance = between(0.0, 0.1);
    if (chance(0.3)) edit.color = Color{static_cast<float>(between(0.0, 1.0)), 0.5f, 0.5f, 1.0f};
    if (chance(0.1)) edit.group = static_cast<std::uint32_t>(1 + index(7));
    if (chance(0.1)) edit.mask = 0xffffffffu - static_cast<std::uint32_t>(index(7));
    return edit;
  }

 private:
  std::mt19937_64 random_;
};

constexpr std::size_t kKinds = std::variant_size_v<commands::Any>;

/// A command of this kind that the world takes. `number` makes new names.
Command anyCommand(Draw& draw, const World& world, std::size_t kind, int number) {
  using namespace commands;
  std::vector<std::string> movable, all;
  for (const BodyDescription& body : *world.bodies()) {
    all.push_back(body.name);
    if (body.kind == BodyKind::Dynamic) movable.push_back(body.name);
  }
  const std::string any = all[draw.index(all.size())], body = movable[draw.index(movable.size())];
  const std::string fresh = "new/" + std::to_string(number);
  const Vec3 force = draw.vector(20.0), torque = draw.vector(2.0), point = draw.vector(1.0);
  switch (kind) {
    case 0:
      return {AddBodies{{draw.body(fresh), draw.body(fresh + "b")}}};
    case 1:
      return {RemoveBody{any}};
    case 2:
      return {Clear{}};
    case 3: {
      BodyEdit edit = draw.edit();
      if (draw.chance(0.2)) edit.name = fresh;
      if (draw.chance(0.1)) edit.kind = BodyKind::Kinematic;
      return {EditBody{body, edit}};
    }
    case 4:
      return {ApplyImpulse{body, force, point}};
    case 5:
      return {ApplyWrench{body, force, torque, point, draw.between(0.01, 0.5)}};
    case 6:
      return {CommandWrench{body, force, torque, point, draw.between(0.01, 0.5)}};
    case 7:
      return {GrabBody{body, Grab{draw.vector(0.1), draw.vector(2.0), draw.between(1.0, 6.0), 300.0}}};
    case 8:
      return {HoldBody{any, draw.pose()}};
    case 9:
      return {ReleaseBody{any}};
    case 10:
      return {SetGravity{draw.vector(10.0)}};
    case 11:
      return {SetAir{draw.chance(0.7) ? std::optional<Air>({draw.between(0.5, 2.0)}) : std::nullopt}};
    case 12:
      if (!world.scene().air || draw.chance(0.3)) return {SetWind{}};
      return {SetWind{Wind{draw.vector(5.0), draw.between(0.0, 2.0)}}};
    case 13:
      if (draw.chance(0.3)) return {SetFluid{}};
      return {SetFluid{Fluid{draw.between(500.0, 1500.0), draw.between(0.1, 1.0)}}};
    case 14: {
      Setting setting(draw.chance(0.5) ? Fidelity::Preview : Fidelity::Accurate);
      if (draw.chance(0.5)) setting.divisions = 2;
      if (draw.chance(0.3)) setting.sub_steps = 5;
      if (draw.chance(0.3)) setting.tolerance = draw.between(1e-9, 1e-3);
      return {SetFidelity{setting}};
    }
    case 15: {
      if (draw.chance(0.3)) return {SetGoal{}};
      Goal goal;
      goal.max_error = draw.between(1e-4, 1.0);
      return {SetGoal{goal}};
    }
    default:
      if (draw.chance(0.3)) return {SetEffects{}};
      return {SetEffects{{{Effect::Friction, draw.chance(0.5)}, {Effect::Sleeping, draw.chance(0.5)}}}};
  }
}

SceneDef someBodies() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.name = "some_bodies";
  scene.bodies.push_back(box("low", {1.0, 1.0, 1.0}, {0.0, 0.0, 0.5}));
  scene.bodies.push_back(box("high", {0.8, 0.9, 1.0}, {0.1, 0.0, 1.5}));
  scene.bodies.push_back(ball("ball", 0.3, {1.5, 0.0, 0.3}));
  scene.bodies.back().twist.v_WB = {-1.0, 0.0, 0.0};
  return scene;
}

/// Whether the world takes it; where not, nothing has changed.
bool takes(World& world, const Command& command) {
  try {
    execute(world, command);
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

TEST(Commands, EachIsJournalledAsItWasGivenAndReadsBackToTheSameBits) {
  std::array<int, kKinds> taken{};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Draw draw(seed);
    World world(someBodies()), twin(someBodies());
    std::vector<Command> journal;
    world.setJournal([&](const Command& command) { journal.push_back(command); });
    for (int k = 0; k < 30; ++k) {
      std::size_t kind = draw.index(kKinds);
      if (kind == 2 && draw.chance(0.8)) kind = 0;
      if (world.bodies()->size() < 3) kind = 0;
      bool some_move = false;
      for (const BodyDescription& body : *world.bodies()) some_move |= body.kind == BodyKind::Dynamic;
      if (!some_move) execute(world, {commands::AddBodies{{draw.body("again_" + std::to_string(k))}}});
      const Command command = anyCommand(draw, world, kind, k);
      const std::size_t before = journal.size();
      const std::uint64_t hash = world.stateHash();
      const bool was_taken = takes(world, command), is_kept = journal.size() == before + 1;
      const bool changes_nothing = was_taken && world.stateHash() == hash;
      ASSERT_TRUE(is_kept || (journal.size() == before && (!was_taken || changes_nothing))) << command.name();
      ASSERT_LE(is_kept, was_taken) << command.name();
      if (is_kept) {
        ASSERT_EQ(writeCommand(journal.back()), writeCommand(command));
        ++taken[kind];
      }
      const std::size_t steps = draw.index(4);
      for (; !journal.empty(); journal.erase(journal.begin())) {
        const std::string text = writeCommand(journal.front());
        const Command again = parseCommand(text, "command");
        ASSERT_EQ(writeCommand(again), text);
        ASSERT_EQ(text.find('\n'), std::string::npos);
        ASSERT_NO_THROW(execute(twin, again)) << text;
      }
      ASSERT_EQ(world.stateHash(), twin.stateHash()) << command.name() << " of seed " << seed;
      for (std::size_t step = 0; step < steps; ++step) world.step(), twin.step();
      ASSERT_EQ(world.stateHash(), twin.stateHash()) << command.name() << " of seed " << seed;
    }
  }
  for (std::size_t kind = 0; kind < kKinds; ++kind) EXPECT_GT(taken[kind], 5) << commands::kNames[kind];
}

TEST(Commands, NamesThatTheWorldChoseAreRecorded) {
  World world(onFloor(0.01, 0.5));
  std::string text;
  world.setJournal([&](const Command& command) { text = writeCommand(command); });
  world.addBody(BodyDef{});
  EXPECT_THAT(text, HasSubstr("add_bodies: {bodies: [{name: \"box_1\""));
}

TEST(Commands, ReleasingAllIsOneCommandForEachBody) {
  World world(someBodies());
  world.grab(world.find("ball"), {});
  world.hold(world.find("low"), {});
  std::vector<std::string> texts;
  world.setJournal([&](const Command& command) { texts.push_back(writeCommand(command)); });
  world.releaseAll();
  EXPECT_THAT(texts, testing::ElementsAre("release: {body: \"ball\"}", "release: {body: \"low\"}"));
}

TEST(Commands, ACopyOfAWorldHasNoJournalAndAMovedOneTakesItAlong) {
  World world(someBodies());
  int commands = 0;
  world.setJournal([&](const Command&) { ++commands; });
  World copy(world);
  copy.setGravity(Vec3::Zero());
  EXPECT_EQ(commands, 0);
  World moved(std::move(world));
  moved.setGravity(Vec3::Zero());
  EXPECT_EQ(commands, 1);
}

std::string refusalOf(const std::string& text) {
  try {
    parseCommand(text, "bag");
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return "";
}

TEST(Commands, FaultyTextIsRefusedWithItsPlace) {
  EXPECT_THAT(refusalOf("grap: {body: a}"), HasSubstr("did you mean 'grab'"));
  EXPECT_THAT(refusalOf("{}"), HasSubstr("one command"));
  EXPECT_THAT(refusalOf("{clear: {}, release: {body: a}}"), HasSubstr("one command"));
  EXPECT_THAT(refusalOf("release: {}"), HasSubstr("release.body; this key is needed"));
  EXPECT_THAT(refusalOf("release: {body: a, seconds: 2}"), HasSubstr("bag:1: release.seconds"));
  EXPECT_THAT(refusalOf("set_gravity: {gravity: [0, 0]}"), HasSubstr("three numbers"));
  EXPECT_THAT(refusalOf("set_fidelity: {fidelity: best}"), HasSubstr("preview, interactive"));
  EXPECT_THAT(refusalOf("edit_body: {body: a, set: {position: [0, 0, 1]}}"), HasSubstr("orientation"));
  EXPECT_THAT(refusalOf("edit_body: {body: a, set: {weight: 2}}"), HasSubstr("edit_body.set.weight"));
}

TEST(Commands, MangledTextIsRefusedOrTakenAndDoesNoHarm) {
  int refused = 0, taken = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Draw draw(seed);
    World world(someBodies());
    std::string text = writeCommand(anyCommand(draw, world, draw.index(kKinds), 1));
    for (std::size_t k = 1 + draw.index(3); k > 0; --k) {
      const std::size_t at = draw.index(text.size());
      switch (draw.index(3)) {
        case 0:
          text[at] = static_cast<char>(draw.index(256));
          break;
        case 1:
          text.erase(at, 1 + draw.index(8));
          break;
        default:
          text.insert(at, text.substr(draw.index(text.size()), 1 + draw.index(8)));
      }
      if (text.empty()) text = "x";
    }
    try {
      execute(world, parseCommand(text, "mangled"));
      ++taken;
    } catch (const InvalidInput&) {
      ++refused;
    }
    world.step();
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(taken, 100);
}

// --- states with user forces

TEST(ExactState, HoldsGrabsHoldsAndFrozenBodies) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Draw draw(seed);
    SceneDef scene = someBodies();
    BodyDef off = ball("off", 0.1, {Limits::max_position, 0.0, 0.0});
    off.twist.v_WB = {1e5, 0.0, 0.0};
    scene.bodies.push_back(off);
    if (draw.chance(0.5)) scene.bodies.back().kind = BodyKind::Kinematic;
    if (draw.chance(0.5)) scene.effects[Effect::Sleeping] = true;
    World world(scene);
    for (std::size_t k = draw.index(60); k > 0; --k) world.step();
    world.grab(world.find("ball"), Grab{draw.vector(0.1), draw.vector(2.0), 3.0, 200.0});
    world.hold(world.find(draw.chance(0.5) ? "high" : "floor"), draw.pose());
    for (std::size_t k = 2 + draw.index(60); k > 0; --k) world.step();
    const std::string text = writeScene(world.capture(), world.captureExactState());
    ASSERT_THAT(text, HasSubstr("frozen:"));
    const SceneFile file = parseScene(text, "checkpoint");
    World again(file.scene, file.state);
    ASSERT_EQ(again.stateHash(), world.stateHash()) << seed;
    for (int k = 0; k < 30; ++k) world.step(), again.step();
    ASSERT_EQ(again.stateHash(), world.stateHash()) << seed;
    again.releaseAll(), world.releaseAll();
    for (int k = 0; k < 30; ++k) world.step(), again.step();
    ASSERT_EQ(again.stateHash(), world.stateHash()) << seed;
  }
}

// --- recordings

/// A simulator that is recorded, and what was seen of it from outside.
struct Session {
  std::vector<Recorded> entries;
  std::vector<std::shared_ptr<const Snapshot>> seen;
  Simulator simulator;

  explicit Session(const SceneDef& scene, double period = 0.5) : simulator(scene, {true, 0.0}) {
    record(period);
  }

  void record(double period) {
    simulator.record([this](Recorded entry) { entries.push_back(std::move(entry)); }, period);
    see();
  }
  void see() { seen.push_back(simulator.snapshot()); }
  void apply(const std::function<void(World&)>& change) {
    simulator.apply([&](World& world) { return change(world), "changed"; });
    see();
  }
  void step(std::uint64_t n) {
    simulator.step(n);
    see();
  }
};

/// An entry as it comes out of its text.
Recorded readBack(const Recorded& entry) {
  Recorded read = entry;
  if (const auto* checkpoint = std::get_if<Recorded::Checkpoint>(&entry.what)) {
    const std::string text = writeScene((*checkpoint)->scene, (*checkpoint)->state);
    read.what = std::make_shared<const SceneFile>(parseScene(text, "checkpoint"));
  } else {
    for (Command& command : std::get<Recorded::Commands>(read.what))
      command = parseCommand(writeCommand(command), "command");
  }
  return read;
}

std::optional<Mismatch> resimulate(Resimulation& resimulation, const std::vector<Recorded>& entries) {
  for (const Recorded& entry : entries)
    if (auto found = resimulation.take(readBack(entry))) return found;
  return resimulation.finish();
}

void expectSeen(Resimulation& resimulation, const Session& session) {
  for (const auto& snapshot : session.seen)
    resimulation.expect(snapshot->world, snapshot->steps, snapshot->hash, snapshot->recorded);
}

/// One thing that a person does.
void doAnything(Session& session, Draw& draw, int k) {
  Simulator& simulator = session.simulator;
  const auto change = [&](World& world) {
    bool some_move = false;
    for (const BodyDescription& body : *world.bodies()) some_move |= body.kind == BodyKind::Dynamic;
    if (!some_move) world.addBody(draw.body("first_" + std::to_string(k)));
    std::size_t kind = draw.index(kKinds);
    if (kind == 2 && draw.chance(0.7)) kind = 7;
    takes(world, anyCommand(draw, world, kind, k));
  };
  switch (draw.index(10)) {
    case 0:
      try {
        simulator.apply([&](World& world) -> std::string {
          change(world);
          throw InvalidInput({{"edit", "", "not this one"}});
        });
      } catch (const InvalidInput&) {
      }
      break;
    case 1:
      simulator.send(change);
      simulator.send(change);
      simulator.edit([](World&) {});
      break;
    case 2:
      if (!simulator.snapshot()->undo.empty()) simulator.undo();
      break;
    case 3:
      if (!simulator.snapshot()->redo.empty()) simulator.redo();
      break;
    case 4:
      draw.chance(0.5) ? simulator.reset() : simulator.load(someBodies());
      break;
    case 5:
    case 6:
      simulator.edit(change);
      break;
    default:
      session.apply(change);
  }
  session.see();
  session.step(1 + draw.index(20));
}

TEST(Recording, SessionsRunAgainToTheSameHashes) {
  std::set<std::string> kinds;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Draw draw(seed);
    Session session(someBodies());
    for (int k = 0; k < 25; ++k) doAnything(session, draw, k);
    Resimulation resimulation;
    expectSeen(resimulation, session);
    const auto mismatch = resimulate(resimulation, session.entries);
    ASSERT_FALSE(mismatch) << "seed " << seed << ", " << mismatch->at << " at step " << mismatch->step
                           << " of world " << mismatch->world << " " << mismatch->refusal;
    std::set<std::vector<std::uint64_t>> moments;
    for (const auto& s : session.seen) moments.insert({s->world, s->steps, s->hash});
    std::size_t hashes = moments.size(), commands = 0;
    for (const Recorded& entry : session.entries) {
      ++hashes;
      const auto* given = std::get_if<Recorded::Commands>(&entry.what);
      if (!given) continue;
      commands += given->size();
      for (const Command& command : *given) kinds.insert(command.name());
    }
    EXPECT_EQ(resimulation.hashes(), hashes);
    EXPECT_EQ(resimulation.commands(), commands);
    EXPECT_EQ(resimulation.world().stateHash(), session.simulator.snapshot()->hash);
  }
  EXPECT_EQ(kinds.size(), kKinds);
}

/// Two pushes, with time between.
Session& push(Session& session) {
  session.step(10);
  session.apply([](World& world) { world.applyImpulse(world.find("ball"), {5.0, 0.0, 1.0}, Vec3::Zero()); });
  session.step(10);
  session.apply([](World& world) { world.applyImpulse(world.find("high"), {0.0, 50.0, 0.0}, Vec3::Zero()); });
  session.step(20);
  return session;
}

commands::ApplyImpulse& impulseOf(Recorded& entry) {
  return std::get<commands::ApplyImpulse>(std::get<Recorded::Commands>(entry.what).front().change);
}

TEST(Recording, AChangedNumberIsFoundAtItsCommand) {
  Session session(someBodies(), 100.0);
  push(session);
  ASSERT_EQ(session.entries.size(), 3u);
  impulseOf(session.entries[1]).impulse_W.x() += 1e-9;
  Resimulation resimulation;
  const auto mismatch = resimulate(resimulation, session.entries);
  ASSERT_TRUE(mismatch);
  EXPECT_EQ(mismatch->step, 10u);
  EXPECT_EQ(mismatch->at, "apply_impulse");
  EXPECT_EQ(mismatch->expected, session.entries[1].hash);
}

// What differs after steps that had a time limit may be the clock's fault. The mismatch says so, even where a later
// setting has none.
TEST(Recording, AMismatchTellsWhetherStepsHadATimeLimit) {
  for (const bool limited : {false, true}) {
    Session session(someBodies(), 100.0);
    session.apply([&](World& world) {
      Setting setting = world.scene().fidelity;
      if (limited) setting.max_solve_ms = 1e4;
      world.setFidelity(setting);
    });
    session.step(5);
    session.apply([](World& world) { world.setFidelity(Fidelity::Accurate); });
    push(session);
    session.entries.back().hash ^= 1;
    Resimulation resimulation;
    const auto mismatch = resimulate(resimulation, session.entries);
    ASSERT_TRUE(mismatch);
    EXPECT_EQ(mismatch->at, "apply_impulse");
    EXPECT_EQ(mismatch->clocked, limited);
  }
}

TEST(Recording, ALostCommandIsFoundByTheNextHash) {
  Session session(someBodies(), 100.0);
  push(session);
  session.entries.erase(session.entries.begin() + 1);
  Resimulation resimulation;
  expectSeen(resimulation, session);
  const auto mismatch = resimulate(resimulation, session.entries);
  ASSERT_TRUE(mismatch);
  EXPECT_EQ(mismatch->at, "status");
  EXPECT_EQ(mismatch->step, 10u);
}

TEST(Recording, AWrongStatusAfterTheLastCommandIsFound) {
  Session session(someBodies());
  push(session);
  Resimulation resimulation;
  expectSeen(resimulation, session);
  const Snapshot& last = *session.seen.back();
  resimulation.expect(last.world, last.steps + 3, 17, last.recorded);
  const auto mismatch = resimulate(resimulation, session.entries);
  ASSERT_TRUE(mismatch);
  EXPECT_EQ(mismatch->expected, 17u);
  EXPECT_EQ(mismatch->step, 43u);
}

// The last entries are lost where a recorder ends between a status and the commands whose work it shows.
TEST(Recording, AStatusThatShowsLostCommandsAtTheEndIsNotCompared) {
  Session session(someBodies(), 100.0);
  push(session);
  ASSERT_EQ(session.entries.size(), 3u);
  session.entries.pop_back();
  for (const std::uint64_t wrong : {0, 1}) {
    Resimulation resimulation;
    expectSeen(resimulation, session);
    if (wrong) resimulation.expect(0, 20, 17, 2);  // it shows no lost command
    const auto mismatch = resimulate(resimulation, session.entries);
    EXPECT_EQ(bool(mismatch), wrong == 1);
    EXPECT_EQ(resimulation.uncovered(), 2u);
  }
}

TEST(Recording, ACommandThatTheWorldRefusesIsAMismatch) {
  Session session(someBodies());
  push(session);
  for (Recorded& entry : session.entries)
    if (std::holds_alternative<Recorded::Commands>(entry.what)) impulseOf(entry).body = "nobody";
  Resimulation resimulation;
  const auto mismatch = resimulate(resimulation, session.entries);
  ASSERT_TRUE(mismatch);
  EXPECT_THAT(mismatch->refusal, HasSubstr("nobody"));
}

TEST(Recording, CheckpointsComeInTimeAndWithEveryWorld) {
  Session session(someBodies(), 0.25);
  session.step(60);
  const auto checkpoints = [&] {
    return std::count_if(session.entries.begin(), session.entries.end(), [](const Recorded& entry) {
      return std::holds_alternative<Recorded::Checkpoint>(entry.what);
    });
  };
  EXPECT_EQ(checkpoints(), 1 + 4);
  session.simulator.reset();
  EXPECT_EQ(checkpoints(), 1 + 4 + 1);
  EXPECT_EQ(session.entries.back().world, 1u);
  EXPECT_EQ(session.entries.back().step, 0u);
}

TEST(Recording, UndoAndRedoGiveCheckpointsAndNoCommands) {
  Session session(someBodies(), 100.0);
  push(session);
  session.apply([](World& world) { world.grab(world.find("ball"), Grab{}); });
  const std::size_t before = session.entries.size();
  session.simulator.undo();
  session.simulator.redo();
  session.simulator.undo();
  session.step(1);
  ASSERT_EQ(session.entries.size(), before + 3);
  for (std::size_t k = before; k < session.entries.size(); ++k)
    EXPECT_TRUE(std::holds_alternative<Recorded::Checkpoint>(session.entries[k].what));
}

TEST(Recording, BeginsWithACheckpointInTheMiddleOfADragAndEndsWhenAsked) {
  Simulator simulator(someBodies(), {true, 0.0});
  simulator.step(20);
  simulator.edit([](World& world) { world.grab(world.find("ball"), Grab{}); });
  simulator.step(5);
  std::vector<Recorded> entries;
  simulator.record([&](Recorded entry) { entries.push_back(std::move(entry)); }, 10.0);
  simulator.step(30);
  simulator.edit([](World& world) { world.release(world.find("ball")); });
  simulator.record(nullptr);
  simulator.edit([](World& world) { world.setGravity(Vec3::Zero()); });
  simulator.step(600);
  ASSERT_EQ(entries.size(), 2u);
  Resimulation resimulation;
  EXPECT_FALSE(resimulate(resimulation, entries));
  EXPECT_EQ(resimulation.steps(), 30u);
}

TEST(Recording, SettingsThatAGoalChoosesAreCommands) {
  SceneDef scene = someBodies();
  scene.goal = Goal{1e-9, std::nullopt};
  Session session(scene, 100.0);
  session.step(120);
  ASSERT_GT(session.entries.size(), 1u);
  EXPECT_STREQ(std::get<Recorded::Commands>(session.entries[1].what).front().name(), "set_fidelity");
  Resimulation resimulation;
  expectSeen(resimulation, session);
  EXPECT_FALSE(resimulate(resimulation, session.entries));
  EXPECT_EQ(resimulation.world().stateHash(), session.simulator.snapshot()->hash);
}

TEST(Recording, WhatIsNoRecordingIsRefused) {
  Session session(someBodies());
  push(session);
  std::vector<Recorded>& entries = session.entries;
  const auto refused = [](std::vector<Recorded> wrong) {
    Resimulation resimulation;
    EXPECT_THROW(resimulate(resimulation, wrong), InvalidInput);
  };
  refused({entries[1]});
  std::vector<Recorded> back = entries;
  back.back().step = 0;
  refused(back);
  Recorded unwritten = entries[0];
  unwritten.what = Recorded::Checkpoint();
  Resimulation resimulation;
  EXPECT_THROW(resimulation.take(unwritten), InvalidInput);
}

}  // namespace
}  // namespace rbs::test

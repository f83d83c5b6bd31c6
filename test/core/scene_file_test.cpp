// SPDX-License-Identifier: BSD-3-Clause
// Scene files: what is written is read back bit for bit, generators make what they say, and a faulty or
// hostile file is refused whole, with every fault at its line.
#include "base/number_text.h"
#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/world.h"
#include "scene/scene_limits.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace rbs {
namespace {

SceneDef parse(const std::string& text) {
  return parseScene(text, "f.yaml").scene;
}

std::vector<Problem> faults(const std::string& text) {
  try {
    parseScene(text, "f.yaml");
    return {};
  } catch (const InvalidInput& error) {
    return error.problems();
  }
}

std::string firstFault(const std::string& text) {
  const std::vector<Problem> problems = faults(text);
  return problems.empty() ? "" : problems[0].path;
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

template <class Value>
bool sameBits(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void expectSameBody(const BodyDef& a, const BodyDef& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(sameShape(a.shape, b.shape)) << shapeName(a.shape) << " and " << shapeName(b.shape);
  EXPECT_TRUE(sameBits(a.pose, b.pose));
  EXPECT_TRUE(sameBits(a.twist, b.twist));
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.density, b.density);
  EXPECT_TRUE(sameBits(a.material.friction, b.material.friction));
  EXPECT_TRUE(sameBits(a.material.restitution, b.material.restitution));
  EXPECT_EQ(a.material.drag_coefficient, b.material.drag_coefficient);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.group, b.group);
  EXPECT_EQ(a.mask, b.mask);
}

void expectSameScene(const SceneDef& a, const SceneDef& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.property, b.property);
  EXPECT_TRUE(sameBits(a.gravity, b.gravity));
  EXPECT_TRUE(sameBits(a.step, b.step));
  EXPECT_EQ(a.fidelity, b.fidelity);
  ASSERT_EQ(a.goal.has_value(), b.goal.has_value());
  EXPECT_EQ(a.goal.value_or(Goal{}).max_error, b.goal.value_or(Goal{}).max_error);
  EXPECT_EQ(a.goal.value_or(Goal{}).max_step_ms, b.goal.value_or(Goal{}).max_step_ms);
  EXPECT_EQ(a.seed, b.seed);
  ASSERT_EQ(a.air.has_value(), b.air.has_value());
  EXPECT_TRUE(!a.air || sameBits(*a.air, *b.air));
  ASSERT_EQ(a.wind.has_value(), b.wind.has_value());
  EXPECT_TRUE(!a.wind || sameBits(*a.wind, *b.wind));
  EXPECT_TRUE(sameBits(a.view, b.view));
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) expectSameBody(a.bodies[i], b.bodies[i]);
}

/// Numbers with all 53 bits in use, spread over many magnitudes.
class Numbers {
 public:
  double any() { return std::ldexp(2.0 * unit_(engine_) - 1.0, static_cast<int>(engine_() % 40) - 25); }
  double positive() { return std::abs(any()) + 1e-5; }
  double unit() { return unit_(engine_); }
  Vec3 vector() {
    const double x = any(), y = any();
    return Vec3(x, y, any());
  }

 private:
  std::mt19937_64 engine_{7};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

Shape anyShape(Numbers& numbers, int index) {
  const double x = numbers.positive(), y = numbers.positive();
  const Vec3 size = Vec3(x, y, numbers.positive()) + Vec3::Constant(1e-3);
  switch (index % 6) {
    case 0:
      return Sphere{size.x()};
    case 1:
      return Box{size};
    case 2:
      return Capsule{size.x(), size.z()};
    case 3:
      return Cylinder{size.x(), size.z()};
    case 4:
      return Cone{size.x(), size.z()};
  }
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) points.push_back(numbers.vector());
  return makeHull(points, "hull").hull;
}

BodyDef anyBody(Numbers& numbers, int index) {
  BodyDef body;
  if (index % 4 != 0) body.name = "body_" + std::to_string(index);
  body.shape = anyShape(numbers, index);
  body.kind = index % 5 == 0 ? BodyKind::Kinematic : BodyKind::Dynamic;
  body.pose.p_WB = numbers.vector();
  body.pose.q_WB = Quat(numbers.unit(), numbers.unit(), -numbers.unit(), numbers.unit());
  body.twist = {numbers.vector(), numbers.vector()};
  if (index % 3 == 0) body.mass = numbers.positive();
  if (index % 3 == 1) body.density = numbers.positive();
  body.material = {numbers.positive(), numbers.unit(), std::nullopt};
  if (index % 2 == 0) body.material.drag_coefficient = numbers.positive();
  if (index % 2 == 1) body.color = Color{0.1f, static_cast<float>(numbers.unit()), 1.0f / 3.0f, 1.0f};
  body.group = static_cast<std::uint32_t>(index);
  body.mask = index % 3 == 0 ? 0u : 0xfffffff0u;
  return body;
}

SceneDef anyScene() {
  Numbers numbers;
  SceneDef scene;
  scene.name = "a \"name\": with \\ and #, \xc3\xa9";
  scene.property = "Two\nlines\tand a bell\x07.";
  scene.gravity = numbers.vector();
  scene.step = 1.0 / 3.0;
  scene.fidelity = Fidelity::Preview;
  scene.fidelity.divisions = 3;
  scene.fidelity.sub_steps = 17;
  scene.fidelity.tolerance = 1e-7 / 3.0;
  scene.fidelity.max_solve_ms = 10.0 / 3.0;
  scene.goal = Goal{1e-3 / 7.0, std::nullopt};
  scene.seed = std::numeric_limits<std::uint64_t>::max();
  scene.air = Air{numbers.positive()};
  scene.wind = Wind{numbers.vector(), numbers.positive()};
  scene.view = {numbers.vector(), numbers.vector()};
  for (int i = 0; i < 60; ++i) scene.bodies.push_back(anyBody(numbers, i));
  scene.bodies[1].name = "null";
  scene.bodies[2].pose.p_WB = Vec3(-0.0, std::numeric_limits<double>::denorm_min(), 1e9);
  scene.bodies[3].twist.w_WB = Vec3(-0.0, 0.0, 0.0);
  BodyDef floor;
  floor.shape = Plane{};
  floor.kind = BodyKind::Static;
  scene.bodies.push_back(floor);
  return scene;
}

TEST(SceneFile, writtenSceneIsReadBackBitForBit) {
  const SceneDef scene = anyScene();
  ASSERT_TRUE(validate(scene).empty());
  expectSameScene(parse(writeScene(scene)), scene);
}

TEST(SceneFile, fidelityIsANameOrANameWithNumbers) {
  EXPECT_EQ(parse("fidelity: accurate").fidelity, Setting(Fidelity::Accurate));
  const SceneDef tuned = parse("fidelity: {preset: preview, divisions: 2, sub_steps: 5, tolerance: 1e-4}");
  EXPECT_EQ(tuned.fidelity.preset, Fidelity::Preview);
  EXPECT_EQ(tuned.fidelity.divisions, 2u);
  EXPECT_EQ(tuned.fidelity.sub_steps, 5u);
  EXPECT_EQ(tuned.fidelity.tolerance, 1e-4);
  EXPECT_FALSE(tuned.goal);
  EXPECT_EQ(parse("fidelity: {max_error: 0.001}").goal->max_error, 0.001);
  EXPECT_EQ(parse("fidelity: {max_step_ms: 2}").goal->max_step_ms, 2.0);
}

TEST(SceneFile, badNumbersOfAFidelityAreRefusedAtTheirLine) {
  const char* const lines[] = {"preset: exact",    "divisions: 0",     "divisions: 1001", "divisions: -1",
                               "divisions: 1.5",   "sub_steps: 0",     "sub_steps: 1001", "tolerance: 0",
                               "tolerance: -1e-6", "tolerance: .nan",  "tolerance: 1",    "max_error: 0",
                               "max_error: -1",    "max_error: .inf",  "max_step_ms: 0",  "max_step_ms: .nan",
                               "max_solve_ms: 0",  "max_solve_ms: -1", "iterations: 3"};
  for (const std::string line : lines) {
    const std::string key = "fidelity." + line.substr(0, line.find(':'));
    try {
      parse("step: 0.01\nfidelity:\n  " + line + "\n");
      ADD_FAILURE() << line;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("f.yaml:3: fidelity."), std::string::npos)
          << line << ": " << error.what();
    }
  }
  EXPECT_THROW(parse("fidelity: {max_error: 1, max_step_ms: 1}"), InvalidInput);
}

TEST(SceneFile, defaultSceneIsReadBack) {
  expectSameScene(parse(writeScene(SceneDef{})), SceneDef{});
  SceneDef one;
  one.bodies.resize(1);
  expectSameScene(parse(writeScene(one)), one);
}

TEST(SceneFile, writtenStateIsReadBackBitForBit) {
  SavedState state;
  state.time = 1.0 / 7.0;
  state.steps = 123456789012345;
  state.contacts = {{0, 2, {{0xffffffffu, 0.1, Vec3(0.2, -0.0, 1e-300)}, {4, 2.0 / 3.0, Vec3::Zero()}}},
                    {1, 60, {}}};
  const SceneFile file = parseScene(writeScene(anyScene(), state), "f.yaml");
  ASSERT_TRUE(file.state);
  EXPECT_TRUE(sameBits(file.state->time, state.time));
  EXPECT_EQ(file.state->steps, state.steps);
  ASSERT_EQ(file.state->contacts.size(), 2u);
  EXPECT_EQ(file.state->contacts[0].b, 2u);
  EXPECT_EQ(file.state->contacts[1].b, 60u);
  ASSERT_EQ(file.state->contacts[0].points.size(), 2u);
  EXPECT_EQ(file.state->contacts[0].points[0].feature, 0xffffffffu);
  EXPECT_EQ(file.state->contacts[0].points[1].normal, 2.0 / 3.0);
  EXPECT_TRUE(sameBits(file.state->contacts[0].points[0].tangent_W, state.contacts[0].points[0].tangent_W));
  EXPECT_FALSE(parseScene(writeScene(anyScene()), "f.yaml").state);
}

// The hull's own frame is not that of its points; the state is that of the former.
TEST(SceneFile, worldWithHullsGoesOnFromItsSavedState) {
  World world(parse(R"(
bodies:
  - {shape: plane, kind: static}
  - {shape: hull, points: [[1, 1, 0], [2, 1, 0], [1, 3, 0.2], [1.3, 1, 1], [2, 2, 1.5]], position: [0, 0, 1],
     rotation: {axis: [1, 2, 3], degrees: 50}, spin: [1, 2, 3]}
  - {shape: capsule, size: [0.1, 0.1, 0.8], position: [3, 0, 1], spin: [3, 2, 1]}
)"));
  for (int k = 0; k < 20; ++k) world.step();
  const SceneFile saved = parseScene(writeScene(world.capture(), world.captureState()), "f.yaml");
  World again(saved.scene, saved.state);
  EXPECT_EQ(again.stateHash(), world.stateHash());
  for (int k = 0; k < 100; ++k) world.step(), again.step();
  EXPECT_EQ(again.stateHash(), world.stateHash());
}

TEST(SceneFile, wrenchesActOnFromASavedState) {
  World world(parse(R"(
bodies:
  - {shape: plane, kind: static}
  - {size: [1, 0.5, 0.5], position: [0, 0, 3], spin: [1, 2, 3]}
)"));
  const BodyId crate = world.find("box_1");
  world.applyWrench(crate, Vec3(10.0, 20.0, 3000.0), Vec3(1.0, 2.0, 3.0), Vec3(0.4, 0.1, 3.0), 1.0);
  world.commandWrench(crate, Vec3(0.0, 100.0, 0.0), Vec3::Zero(), Vec3(0.0, 0.0, 3.2), 0.5);
  for (int k = 0; k < 20; ++k) world.step();
  const SceneFile saved = parseScene(writeScene(world.capture(), world.captureState()), "f.yaml");
  ASSERT_EQ(saved.state->wrenches.size(), 2u);
  World again(saved.scene, saved.state);
  EXPECT_EQ(again.stateHash(), world.stateHash());
  for (World* one : {&world, &again})
    one->commandWrench(one->find("box_1"), Vec3(0.0, -100.0, 0.0), Vec3::Zero(), Vec3::Zero(), 0.5);
  for (int k = 0; k < 100; ++k) world.step(), again.step();
  EXPECT_EQ(again.stateHash(), world.stateHash());
  EXPECT_TRUE(again.captureState().wrenches.empty());
}

TEST(SceneFile, poseOfAHullIsThatOfItsPoints) {
  const SceneDef scene = parse(R"(
bodies:
  - {shape: hull, points: [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], scale: 0.5, position: [10, 20, 30],
     rotation: {axis: [0, 0, 1], degrees: 90}}
)");
  const BodyDef& body = scene.bodies.at(0);
  EXPECT_TRUE(body.pose.p_WB.isApprox(Vec3(9.5, 20.5, 30.5), 1e-15));
  std::vector<Vec3> corners{{10, 20, 30}, {10, 22, 30}, {8, 20, 30}, {10, 20, 32}};
  for (const Vec3& v : std::get<ConvexHull>(body.shape).polyhedron->vertices) {
    const Vec3 v_W = body.pose.p_WB + body.pose.q_WB * v;
    const auto near = [&](const Vec3& corner) { return (corner - v_W).norm() < 1e-13; };
    EXPECT_TRUE(std::any_of(corners.begin(), corners.end(), near)) << v_W.transpose();
  }
}

TEST(SceneFile, hashOfAStateTellsHullsApart) {
  const auto hash = [](double x) {
    SceneDef scene;
    BodyDef body;
    // Two mirror images with the same extents, volume and moments.
    body.shape =
        makeHull({{x, 0.2, 0.1}, {-x, -0.2, 0.1}, {0.3, 0.5, -1}, {-0.3, -0.5, -1}, {0, 0, 1}}, "h").hull;
    scene.bodies.push_back(body);
    return World(scene).stateHash();
  };
  EXPECT_EQ(hash(1.0), hash(1.0));
  EXPECT_NE(hash(1.0), hash(-1.0));
}

TEST(SceneFile, faultySceneIsNotWritten) {
  SceneDef scene;
  scene.gravity.x() = std::nan("");
  EXPECT_THROW(writeScene(scene), InvalidInput);
}

TEST(SceneFile, sceneThatCouldNotBeReadBackIsNotWritten) {
  SceneDef scene;
  scene.bodies.resize(kMostBodies + 1);
  EXPECT_THROW(writeScene(scene), InvalidInput);
}

TEST(SceneFile, shortFormsAreRead) {
  const SceneDef scene = parse(R"(
bodies:
  - {shape: sphere, size: 3}
  - {size: 2, rotation: {axis: [0, 0, 2], degrees: 90}}
  - {size: [1, 2, 3], color: [1, 0.5, 0], mask: 0xff}
  - {shape: plane, kind: static}
  - {}
  - {shape: capsule, size: [0.5, 0.5, 2]}
  - {shape: capsule, size: 0.5, half_length: 0.75}
  - {shape: capsule, size: 3}
  - {shape: cylinder, size: [1, 1, 3]}
  - {shape: cone, size: 2}
  - {shape: cone}
air: {}
)");
  ASSERT_EQ(scene.bodies.size(), 11u);
  EXPECT_TRUE(sameShape(scene.bodies[5].shape, Capsule{0.25, 0.75}));
  EXPECT_TRUE(sameShape(scene.bodies[6].shape, Capsule{0.25, 0.75}));
  EXPECT_TRUE(sameShape(scene.bodies[7].shape, Capsule{1.5, 0.0}));
  EXPECT_TRUE(sameShape(scene.bodies[8].shape, Cylinder{0.5, 1.5}));
  EXPECT_TRUE(sameShape(scene.bodies[9].shape, Cone{1.0, 2.0}));
  EXPECT_TRUE(sameShape(scene.bodies[10].shape, Cone{}));
  EXPECT_EQ(fullExtents(scene.bodies[0].shape), Vec3::Constant(3.0));
  EXPECT_EQ(fullExtents(scene.bodies[1].shape), Vec3::Constant(2.0));
  EXPECT_TRUE((scene.bodies[1].pose.q_WB * Vec3::UnitX()).isApprox(Vec3::UnitY(), 1e-15));
  EXPECT_EQ(fullExtents(scene.bodies[2].shape), Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(scene.bodies[2].color, (Color{1.0f, 0.5f, 0.0f, 1.0f}));
  EXPECT_EQ(scene.bodies[2].mask, 255u);
  expectSameBody(scene.bodies[4], BodyDef{});
  EXPECT_EQ(scene.air->density, Air{}.density);
}

TEST(SceneFile, repeatMakesAGrid) {
  const std::vector<BodyDef> bodies =
      parse("bodies: [{name: a, position: [1, 2, 3], repeat: {count: [2, 1, 3], spacing: [0.5, 9, -1]}}]")
          .bodies;
  ASSERT_EQ(bodies.size(), 6u);
  EXPECT_EQ(bodies[0].name, "a_1");
  EXPECT_EQ(bodies[5].name, "a_6");
  EXPECT_EQ(bodies[0].pose.p_WB, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(bodies[1].pose.p_WB, Vec3(1.5, 2.0, 3.0));
  EXPECT_EQ(bodies[5].pose.p_WB, Vec3(1.5, 2.0, 1.0));
}

TEST(SceneFile, pyramidRestsRowOnRow) {
  const std::vector<BodyDef> bodies =
      parse("bodies: [{name: a, size: [2, 1, 0.5], position: [0, 0, 1], pyramid: {rows: 3, gap: 0.25}}]")
          .bodies;
  ASSERT_EQ(bodies.size(), 6u);
  EXPECT_EQ(bodies[0].pose.p_WB, Vec3(-2.25, 0.0, 1.0));
  EXPECT_EQ(bodies[2].pose.p_WB, Vec3(2.25, 0.0, 1.0));
  EXPECT_EQ(bodies[3].pose.p_WB, Vec3(-1.125, 0.0, 1.5));
  EXPECT_EQ(bodies[5].pose.p_WB, Vec3(0.0, 0.0, 2.0));
}

TEST(SceneFile, ringTurnsEachCopyWithItsPlace) {
  const std::vector<BodyDef> bodies =
      parse("bodies: [{name: a, position: [1, 2, 3], velocity: [0, 1, 0], ring: {count: 4, radius: 2}}]")
          .bodies;
  ASSERT_EQ(bodies.size(), 4u);
  EXPECT_EQ(bodies[0].pose.p_WB, Vec3(3.0, 2.0, 3.0));
  EXPECT_LE((bodies[1].pose.p_WB - Vec3(1.0, 4.0, 3.0)).norm(), 1e-15);
  EXPECT_LE((bodies[1].twist.v_WB - Vec3(-1.0, 0.0, 0.0)).norm(), 1e-15);
  EXPECT_LE((bodies[1].pose.q_WB * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  const Vec3 turned = parse("bodies: [{ring: {count: 1, radius: 2, degrees: 90}}]").bodies[0].pose.p_WB;
  EXPECT_LE((turned - Vec3(0.0, 2.0, 0.0)).norm(), 1e-15);
}

TEST(SceneFile, houseOfCardsHasPairsThatTouchAndCardsAcross) {
  const std::vector<BodyDef> bodies =
      parse("bodies: [{name: a, size: [0.002, 0.2, 0.4], position: [0, 0, 1], card_house: {floors: 3}}]")
          .bodies;
  ASSERT_EQ(bodies.size(), 6u + 2u + 4u + 1u + 2u);
  // The lower corner of a leaning card is on the ground, its upper one at the middle of its pair.
  const Pose& left = bodies[2].pose;
  EXPECT_NEAR((left.p_WB + left.q_WB * Vec3(0.001, 0.0, -0.2)).z(), 1.0, 1e-15);
  EXPECT_NEAR((left.p_WB + left.q_WB * Vec3(0.001, 0.0, 0.2)).x(), 0.0, 1e-15);
  EXPECT_NEAR((left.p_WB + left.q_WB * Vec3(-0.001, 0.0, 0.2)).z() + 0.001, bodies[6].pose.p_WB.z(), 1e-15);
}

TEST(SceneFile, copiesFlyAtTheirSpeedInAllDirections) {
  const std::vector<BodyDef> bodies =
      parse("bodies: [{repeat: {count: [5, 5, 5], spacing: [2, 2, 2], speed: 3}}]").bodies;
  Vec3 mean = Vec3::Zero();
  for (const BodyDef& body : bodies) {
    EXPECT_NEAR(body.twist.v_WB.norm(), 3.0, 1e-14);
    mean += body.twist.v_WB / bodies.size();
  }
  EXPECT_LT(mean.norm(), 0.5);
}

const char* const kScattered = R"(
seed: 5
bodies:
  - {name: s, size: 0.5, repeat: {count: [4, 5, 6], spacing: [2, 2, 2], jitter: 0.25, turn: random, scale: [0.5, 1.5],
     shapes: [sphere, box]}}
)";

TEST(SceneFile, scatteredBodiesKeepTheirBounds) {
  const std::vector<BodyDef> bodies = parse(kScattered).bodies;
  int balls = 0;
  Vec3 mean_axis = Vec3::Zero();
  for (const BodyDef& body : bodies) {
    balls += std::holds_alternative<Sphere>(body.shape);
    const double size = fullExtents(body.shape).x();
    EXPECT_TRUE(size >= 0.25 && size <= 0.75) << size;
    for (const double x : body.pose.p_WB) EXPECT_LE(std::abs(x - 2.0 * std::round(x / 2.0)), 0.25);
    EXPECT_NEAR(body.pose.q_WB.norm(), 1.0, 1e-15);
    mean_axis += body.pose.q_WB * Vec3::UnitZ() / bodies.size();
  }
  EXPECT_NEAR(balls, 60, 20);
  EXPECT_LT(mean_axis.norm(), 0.3);
}

// The digits were computed by another program from the published definition of SplitMix64 and from the
// order of the draws: the same seed gives these bodies on every machine.
TEST(SceneFile, scatteringIsTheSameOnEveryMachine) {
  const BodyDef body = parse(kScattered).bodies[0];
  EXPECT_EQ(shapeName(body.shape), "box");
  EXPECT_EQ(fullExtents(body.shape).x(), 0.30293445609267244);
  EXPECT_EQ(body.pose.p_WB, Vec3(0.18193158139476717, 0.13901935008841698, -0.1380671621196447));
  EXPECT_EQ(body.pose.q_WB.coeffs(), Eigen::Vector4d(0.3749287824238292, 0.1400717791805115,
                                                     0.8252815281060247, -0.39839516080692505));
}

TEST(SceneFile, seedDecidesTheScattering) {
  const auto positionOf = [](std::optional<std::uint64_t> seed) {
    return parseScene(kScattered, "f.yaml", seed).scene.bodies[7].pose.p_WB;
  };
  EXPECT_EQ(positionOf({}), positionOf(5));
  EXPECT_NE(positionOf({}), positionOf(6));
  EXPECT_EQ(parseScene(kScattered, "f.yaml", 6).scene.seed, 6u);
}

TEST(SceneFile, everyFaultIsTold) {
  const std::vector<Problem> problems = faults(R"(gravty: [0, 0, 1]
gravity: [0, 0]
wind: {gust: -1}
bodies:
  - {name: 1ab, frction: 3, mass: 1, density: 1}
  - name: ok
    kind: static
    velocity: [1, 0, 0]
    spin: [0, .inf, 0]
  - {name: twin}
  - {name: twin,
     restitution: 2}
  - {kind: statc, orientation: [0, 0, 0, 1], rotation: {axis: [0, 0, 0], degrees: 1}}
  - {color: [2, 0, 1], repeat: {count: [3, 1, 1], spacing: [1, 1, 1]}}
)");
  std::vector<std::string> paths;
  for (const Problem& problem : problems) paths.push_back(problem.path);
  EXPECT_EQ(
      paths,
      (std::vector<std::string>{
          "f.yaml:1: gravty", "f.yaml:2: gravity", "f.yaml:3: wind", "f.yaml:3: wind.gust",
          "f.yaml:5: bodies[0].frction", "f.yaml:5: bodies[0].name", "f.yaml:5: bodies[0].density",
          "f.yaml:8: bodies[1].velocity", "f.yaml:9: bodies[1].spin[1]", "f.yaml:11: bodies[3].name",
          "f.yaml:12: bodies[3].restitution", "f.yaml:13: bodies[4].kind", "f.yaml:13: bodies[4].rotation",
          "f.yaml:13: bodies[4].rotation.axis", "f.yaml:14: bodies[5].color"}));
}

TEST(SceneFile, misspelledKeyNamesTheNearest) {
  const std::vector<Problem> problems = faults("bodies: [{frction: 1}]");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].allowed.find("did you mean 'friction'?"), std::string::npos);
}

TEST(SceneFile, wrongTypesAreRefused) {
  for (const char* text : {"",
                           "3",
                           "[]",
                           "gravity: 9.81",
                           "gravity: [0, 0, x]",
                           "step: fast",
                           "step: \"0.01\"",
                           "step: nan",
                           "step: .inf",
                           "step: 1e999",
                           "step: 0.01s",
                           "step:",
                           "seed: -1",
                           "seed: 1.5",
                           "seed: 18446744073709551616",
                           "fidelity: best",
                           "air: 1.2",
                           "air:",
                           "wind: {velocity: [1, 2, 3, 4]}",
                           "bodies: 3",
                           "bodies: {a: 1}",
                           "bodies: [3]",
                           "bodies: [{size: 0}]",
                           "bodies: [{size: [1, 1]}]",
                           "bodies: [{shape: sphere, size: [1, 1, 1]}]",
                           "bodies: [{shape: plane, kind: static, size: 1}]",
                           "bodies: [{shape: ball}]",
                           "bodies: [{shape: cylinder, size: [1, 2, 1]}]",
                           "bodies: [{shape: cylinder, size: 0}]",
                           "bodies: [{shape: cone, size: [1, 1]}]",
                           "bodies: [{shape: cone, size: [1, 1, -1]}]",
                           "bodies: [{shape: cone, half_length: 1}]",
                           "bodies: [{shape: capsule, size: [1, 1, 0.5]}]",
                           "bodies: [{shape: capsule, size: [1, 1, 2], half_length: 0.5}]",
                           "bodies: [{shape: capsule, size: 1, half_length: -0.5}]",
                           "bodies: [{points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}]",
                           "bodies: [{shape: hull}]",
                           "bodies: [{shape: hull, points: 3}]",
                           "bodies: [{shape: hull, points: [1, 2, 3]}]",
                           "bodies: [{shape: hull, mesh: [a]}]",
                           "bodies: [{shape: hull, mesh: nowhere.stl}]",
                           "bodies: [{name: [a]}]",
                           "bodies: [{orientation: [0, 0, 1]}]",
                           "bodies: [{mask: 4294967296}]",
                           "bodies: [{group: 0x}]",
                           "property: [a]",
                           "property: {a: b}",
                           "bodies: [{rotation: {axis: [0, 0, 1]}}]",
                           "bodies: [{rotation: {degrees: 1}}]"}) {
    EXPECT_NE(firstFault(text), "") << text;
  }
}

// Where the four points of a corner make a hull, each of these does not.
TEST(SceneFile, faultyHullsAreRefusedAtTheirLine) {
  const std::string corner = "[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]";
  const auto fault = [](const std::string& text) {
    return firstFault("bodies:\n  - shape: hull\n    " + text);
  };
  EXPECT_EQ(fault("points: " + corner), "");
  EXPECT_EQ(fault("points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]"), "f.yaml:3: bodies[0].points");
  EXPECT_EQ(fault("points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]"), "f.yaml:3: bodies[0].points");
  EXPECT_EQ(fault("points:\n      - [0, 0, 0]\n      - [1, 0, 0]\n      - [0, 1, 0]\n      - [0, 0, 2e9]"),
            "f.yaml:7: bodies[0].points[3]");
  EXPECT_EQ(fault("points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, .nan]]"),
            "f.yaml:3: bodies[0].points[3][2]");
  EXPECT_EQ(fault("points: " + corner + "\n    mesh: a.stl"), "f.yaml:2: bodies[0].shape");
  EXPECT_EQ(fault("points: " + corner + "\n    size: 1"), "f.yaml:4: bodies[0].size");
  EXPECT_EQ(fault("points: " + corner + "\n    scale: 0"), "f.yaml:4: bodies[0].scale");
  EXPECT_EQ(fault("points: " + corner + "\n    scale: 1e7"), "f.yaml:3: bodies[0].points");
  EXPECT_EQ(fault("points: " + corner + "\n    scale: 1e-7"), "f.yaml:3: bodies[0].points");
  EXPECT_EQ(fault("points: " + corner + "\n    scale: 1e300"), "f.yaml:3: bodies[0].points[1]");
  EXPECT_EQ(fault("points: " + corner +
                  "\n    repeat: {count: [2, 1, 1], spacing: [3, 0, 0], scale: [1e99, 1e99]}"),
            "f.yaml:4: bodies[0].repeat");
}

TEST(SceneFile, faultyGeneratorsAreRefused) {
  for (const char* text : {"repeat: {count: [0, 1, 1], spacing: [1, 1, 1]}",
                           "repeat: {count: [2, 1, 1]}",
                           "repeat: {spacing: [1, 1, 1]}",
                           "repeat: {count: [2, 1.5, 1], spacing: [1, 1, 1]}",
                           "repeat: {count: [-2, 1, 1], spacing: [1, 1, 1]}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], jitter: -1}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], scale: [2, 1]}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], scale: [0, 1]}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], shapes: [plane]}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], shapes: []}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], turn: left}",
                           "pyramid: {rows: 0}",
                           "pyramid: {}",
                           "pyramid: 3",
                           "pyramid: {rows: 2, gap: -1}",
                           "shape: sphere, pyramid: {rows: 2}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1], speed: -1}",
                           "repeat: {count: [1, 1, 1], spacing: [1, 1, 1]}, pyramid: {rows: 2}",
                           "ring: {count: 0, radius: 1}",
                           "ring: {count: 3, radius: 0}",
                           "ring: {count: 3}",
                           "card_house: {floors: 0}",
                           "card_house: {floors: 2, degrees: 45}",
                           "card_house: {}",
                           "shape: sphere, card_house: {floors: 2}",
                           "ring: {count: 3, radius: 1}, pyramid: {rows: 2}"}) {
    EXPECT_NE(firstFault("bodies: [{" + std::string(text) + "}]"), "") << text;
  }
}

TEST(SceneFile, tooManyBodiesAreRefusedBeforeTheyAreMade) {
  for (const char* text :
       {"repeat: {count: [4000000000, 4000000000, 4000000000], spacing: [1, 1, 1]}",
        "repeat: {count: [100001, 1, 1], spacing: [1, 1, 1]}", "pyramid: {rows: 4000000000}"}) {
    EXPECT_EQ(firstFault("bodies: [{" + std::string(text) + "}]"), "f.yaml:1: bodies[0]") << text;
  }
  const std::string half = "  - {repeat: {count: [50000, 1, 1], spacing: [1, 0, 0]}}\n";
  EXPECT_EQ(firstFault("bodies:\n" + half + half), "");
  EXPECT_EQ(firstFault("bodies:\n" + half + half + "  - {}\n"), "f.yaml:4: bodies[2]");
}

TEST(SceneFile, stateThatDoesNotFitTheBodiesIsRefused) {
  const auto fault = [](const std::string& state) { return firstFault("bodies: [{}, {}]\nstate: " + state); };
  EXPECT_EQ(fault("{time: 1, steps: 2, contacts: [{a: 0, b: 1, points: []}]}"), "");
  EXPECT_EQ(fault("{time: -1}"), "f.yaml:2: state.time");
  EXPECT_EQ(fault("{contacts: [{a: 0, b: 2}]}"), "f.yaml:2: state.contacts[0].b");
  EXPECT_EQ(fault("{contacts: [{a: 1, b: 1}]}"), "f.yaml:2: state.contacts[0].b");
  EXPECT_EQ(fault("{contacts: [{a: 0}]}"), "f.yaml:2: state.contacts[0].b");
  EXPECT_EQ(fault("{contacts: 3}"), "f.yaml:2: state.contacts");
  EXPECT_EQ(fault("{contacts: [{a: 0, b: 1, points: [{feature: 1, normal: .nan, tangent: [0, 0, 0]}]}]}"),
            "f.yaml:2: state.contacts[0].points[0].normal");
}

TEST(SceneFile, repeatedKeysAreRefused) {
  EXPECT_EQ(firstFault("step: 0.01\nseed: 1\nstep: 0.02"), "f.yaml:3: step");
  EXPECT_EQ(firstFault("bodies: [{}, {mass: 1, mass: 2}]"), "f.yaml:1: bodies[1].mass");
}

TEST(SceneFile, endlessFaultsAreCut) {
  EXPECT_EQ(faults("bodies: [" + repeated("1,", 50000) + "]").size(), 1000u);
  std::string keys;
  for (int i = 0; i < 50000; ++i) keys += "k" + std::to_string(i) + ": 1\n";
  EXPECT_EQ(firstFault(keys), "f.yaml:65");
}

TEST(SceneFile, faultIsPlacedAtItsKey) {
  EXPECT_EQ(firstFault("seed: 1\nstep:\n\n  fast"), "f.yaml:2: step");
}

TEST(SceneFile, deepNestingIsRefused) {
  const std::vector<Problem> problems = faults("bodies: " + std::string(12, '[') + std::string(12, ']'));
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].allowed, "at most 12 levels of nesting");
}

TEST(SceneFile, hostileTextIsRefused) {
  const std::string bomb = "a: &a [1, 1]\nb: &b [*a, *a]\nbodies: [*b, *b]";
  EXPECT_NE(firstFault(bomb), "");
  EXPECT_NE(firstFault("bodies: &x [*x]"), "");
  EXPECT_NE(firstFault(std::string(100000, '[')), "");
  EXPECT_NE(firstFault(repeated("{a: ", 100000)), "");
  EXPECT_NE(firstFault(repeated("- ", 100000)), "");
  EXPECT_NE(firstFault(repeated("? ", 100000)), "");
  EXPECT_EQ(firstFault("bodies: [" + repeated("~,", 5000001) + "]"), "f.yaml:1: bodies[4999997]");
  EXPECT_NE(firstFault("? [a]\n: b"), "");
  EXPECT_NE(firstFault("step: !!float 0.01"), "");
  EXPECT_NE(firstFault("step: 0.01\n---\nstep: 0.02"), "");
  EXPECT_EQ(firstFault("step: 0.01\nseed: [1"), "f.yaml:2");
  EXPECT_EQ(firstFault(std::string("step: 0.01\n\0", 12)), "f.yaml:2");
  EXPECT_EQ(firstFault("step: 0.01\n\x04gravity: 3"), "f.yaml:2");
  EXPECT_NE(firstFault(std::string(kMostSceneBytes + 1, ' ')), "");
}

TEST(SceneFile, randomDamageNeverEscapesTheCheck) {
  const std::string sound = writeScene(anyScene());
  std::mt19937_64 engine(3);
  for (int trial = 0; trial < 100; ++trial) {
    std::string text = sound;
    for (int hit = 0; hit < 3; ++hit) text[engine() % text.size()] = static_cast<char>(engine() % 256);
    try {
      EXPECT_TRUE(validate(parse(text)).empty());
    } catch (const InvalidInput& error) {
      EXPECT_FALSE(error.problems().empty());
    }
  }
}

class SceneFiles : public testing::Test {
 protected:
  SceneFiles() { std::filesystem::create_directories(folder_); }
  ~SceneFiles() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::string file = (folder_ / name).string();
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("scene_file_test_" + std::to_string(std::random_device{}()));
};

TEST_F(SceneFiles, fileWithoutANameIsCalledAfterItself) {
  EXPECT_EQ(readScene(write("shelf.yaml", "step: 0.01")).scene.name, "shelf");
  EXPECT_EQ(readScene(write("shelf.yaml", "name: other")).scene.name, "other");
}

TEST_F(SceneFiles, whatIsNoReadableFileIsRefused) {
  EXPECT_THROW(readScene((folder_ / "missing.yaml").string()), InvalidInput);
  EXPECT_THROW(readScene(folder_.string()), InvalidInput);
  EXPECT_THROW(readScene("/dev/zero"), InvalidInput);
  EXPECT_THROW(readScene(""), InvalidInput);
}

TEST_F(SceneFiles, fileOver64MiBIsRefused) {
  EXPECT_THROW(readScene(write("over.yaml", "step: 0.01\n" + std::string(kMostSceneBytes, '#'))),
               InvalidInput);
}

// It cleared as much memory as the largest file has: 64 MiB, or 16,384 pages.
TEST_F(SceneFiles, readingASmallFileTakesLittleMemory) {
  const std::string file = write("small.yaml", "bodies:\n  - {shape: sphere, size: 1}\n");
  const auto pages = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_minflt;
  };
  const long before = pages();
  readScene(file);
  EXPECT_LT(pages() - before, 4000);
}

TEST(SceneFile, theMostBodiesAreWrittenReadBackAndStepped) {
  SceneDef scene;
  for (std::size_t k = 0; k < kMostBodies; ++k) {
    BodyDef body;
    body.name = "body_" + std::to_string(k);
    if (k % 2) body.shape = Box{{0.3, 0.2 + 1e-7 * static_cast<double>(k), 0.1}};
    body.pose.p_WB = Vec3(static_cast<double>(k % 50), static_cast<double>(k / 50 % 50),
                          1.0 / 3.0 + static_cast<double>(k / 2500));
    body.pose.q_WB = Quat(Eigen::AngleAxisd(0.1 * static_cast<double>(k), Vec3(1, 2, 3).normalized()));
    scene.bodies.push_back(body);
  }
  World world(scene), again(parseScene(writeScene(scene), "most.yaml").scene);
  EXPECT_EQ(again.stateHash(), world.stateHash());
  world.step(), again.step();
  EXPECT_EQ(again.stateHash(), world.stateHash());

  scene.bodies.push_back(scene.bodies.front());
  scene.bodies.back().name = "one_more";
  try {
    writeScene(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "bodies: 100001 (allowed: at most 100000 in a scene file)");
  }
}

TEST(NumberText, isShortAndReadsBack) {
  EXPECT_EQ(numberText(0.1), "0.1");
  EXPECT_EQ(numberText(-9.81), "-9.81");
  EXPECT_EQ(numberText(0.1f), "0.1");
  EXPECT_EQ(numberText(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(numberText(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(numberText(std::nan("")), "nan");
  for (const char* bad : {"", " 1", "1 ", "1x", "nan", "inf", "1e999", "0x10", "--1", "1e"}) {
    EXPECT_FALSE(parseNumber(bad)) << bad;
  }
}

TEST(NearestName, findsMisspellingsOnly) {
  const std::vector<std::string> names{"tower", "pyramid", "dominoes"};
  EXPECT_EQ(nearestName("towr", names), "tower");
  EXPECT_EQ(nearestName("piramyd", names), "pyramid");
  EXPECT_EQ(nearestName("zzz", names), "");
  EXPECT_EQ(nearestName(std::string(100000, 'x'), names), "");
}

TEST(SceneFile, nothingIsQuotedOfAFileThatIsNoScene) {
  const std::string file = testing::TempDir() + "no_scene_" + std::to_string(getpid()) + ".yaml";
  for (const char* text : {"root:x:0:0:secret:/root\n", "password: secret\n", "gravity: secret", "- secret\n",
                           "*secret", "!secret x", "[[secret", "key: [secret\n\x01", "%secret"}) {
    std::ofstream(file) << text;
    try {
      readScene(file);
      ADD_FAILURE() << text;
    } catch (const InvalidInput& refusal) {
      EXPECT_EQ(std::string(refusal.what()).find("secret"), std::string::npos) << refusal.what();
      EXPECT_NE(std::string(refusal.what()).find("not a scene"), std::string::npos) << refusal.what();
    }
  }
  std::remove(file.c_str());
}

TEST(SceneFile, refusalsStayShortAndPrintable) {
  const std::string word(100'000, 'x');
  for (const std::string& text :
       {"bodies: [{name: " + word + "}]", "bodies: [{" + word + ": 1}]", word + ": 1\nbodies: []",
        "bodies: [{shape: " + word + "}]", "bodies: [{mass: " + word + "}]",
        "bodies: [{repeat: {shapes: [" + word + "]}}]", "bodies: !" + word + " []",
        "bodies: [{shape: hull, mesh: " + word + "}]"}) {
    try {
      parseScene(text, "scene.yaml");
      ADD_FAILURE() << text.substr(0, 40);
    } catch (const InvalidInput& refusal) {
      EXPECT_LT(std::string(refusal.what()).size(), 2500u) << text.substr(0, 40);
      EXPECT_EQ(std::string(refusal.what()).find(std::string(300, 'x')), std::string::npos)
          << text.substr(0, 40);
    }
  }
}

TEST(SceneFile, meshesOfASceneAreLimitedTogether) {
  std::string mesh;
  for (int k = 0; k < 30'000; ++k)
    mesh += "v " + std::to_string(k % 7) + " " + std::to_string(k % 11) + " " + std::to_string(k % 13) + "\n";
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "many.obj") << mesh;
  std::string text = "bodies:\n";
  for (int k = 0; k < 200; ++k)
    text += "  - {shape: hull, mesh: many.obj, scale: " + std::to_string(1 + k) + ", position: [0, 0, " +
            std::to_string(100 * k) + "]}\n";
  try {
    parseScene(text, folder + "scene.yaml");
    ADD_FAILURE();
  } catch (const InvalidInput& refusal) {
    EXPECT_NE(refusal.problems().front().value.find("4000000 points"), std::string::npos) << refusal.what();
  }
  std::remove((folder + "many.obj").c_str());
}

}  // namespace
}  // namespace rbs

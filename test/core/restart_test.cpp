// SPDX-License-Identifier: BSD-3-Clause
// A step that missed a contact begins again for the bodies that it concerns, and for no others.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rbs::test {
namespace {

constexpr std::uint32_t kRowBodies = 7;

SceneDef slope(Fidelity fidelity) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.0);
  scene.fidelity = fidelity;
  scene.gravity = Vec3(-2.0, 0.0, -kGravity);
  return scene;
}

// Balls that lean on each other and on a kerb.
void addRow(const std::string& name, double y, SceneDef& scene) {
  scene.bodies.push_back(box(name + "kerb", Vec3(0.2, 1.0, 0.2), Vec3(-0.5, y, 0.1)));
  scene.bodies.back().kind = BodyKind::Static;
  for (int k = 0; k < 4; ++k) scene.bodies.push_back(ball(name + std::to_string(k), 0.5, Vec3(k, y, 0.5)));
}

// Strikes the row, so that its end strikes a ball beside it, and that another one: only the solve of the
// contacts knows that the end of the row will move.
void strike(const std::string& name, double y, double speed, World& world) {
  const auto add = [&](const char* which, double x, double v) {
    BodyDef def = ball(name + which, 0.2, Vec3(x, y, 0.5));
    def.material.friction = 0.0;
    def.twist.v_WB.x() = v;
    world.addBody(def);
  };
  add("striking", -0.701, speed), add("beside", 3.701, 0.0), add("next", 4.102, 0.0);
}

// So many stacks of two boxes, far from the rows.
void addStacks(int stacks, SceneDef& scene) {
  for (int k = 0; k < stacks; ++k)
    for (int level = 0; level < 2; ++level)
      scene.bodies.push_back(box("box_" + std::to_string(k) + "_" + std::to_string(level), {0.4, 0.4, 0.4},
                                 Vec3(50.0 + k % 10, k / 10, 0.2 + 0.4 * level)));
}

void expectEqual(const World& alone, const World& together, const std::string& where) {
  const Snapshot without = alone.snapshot(), with = together.snapshot();
  for (std::size_t i = 0; i < without.states.size(); ++i) {
    const std::string& name = (*without.bodies)[i].name;
    const int j = with.find(name);
    ASSERT_GE(j, 0) << name;
    EXPECT_EQ(with.states[j].pose.p_WB, without.states[i].pose.p_WB) << name << where;
    EXPECT_EQ(with.states[j].pose.q_WB.coeffs(), without.states[i].pose.q_WB.coeffs()) << name << where;
    EXPECT_EQ(with.states[j].twist.v_WB, without.states[i].twist.v_WB) << name << where;
  }
}

// The sums of the impulses of each body, as reported.
Vec3 impulsesOn(const World& world, const std::string& name) {
  const BodyId body = world.find(name);
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& point : world.snapshot().contacts) {
    const Vec3 impulse_W = point.normal_impulse * point.n_W + point.friction_impulse;
    if (point.b == body) sum += impulse_W;
    if (point.a == body) sum -= impulse_W;
  }
  return sum;
}

class Restarts : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, Restarts, testing::Values(Fidelity::Accurate, Fidelity::Reference),
                         [](const auto& info) { return std::string(fidelityName(info.param)); });

// Each goes as it does alone, bit for bit, whether it is among the oldest bodies or the youngest.
TEST_P(Restarts, ConcernNoBodiesThatAreFar) {
  for (const bool stacks_first : {false, true}) {
    SceneDef row = slope(GetParam()), stacks = row, both = row;
    addRow("row_", 0.0, row);
    addStacks(20, stacks);
    if (stacks_first) addStacks(20, both);
    addRow("row_", 0.0, both);
    if (!stacks_first) addStacks(20, both);
    World a(row), b(stacks), c(both);
    for (int k = 0; k < 3; ++k) a.step(), b.step(), c.step();
    strike("row_", 0.0, 100.0, a), strike("row_", 0.0, 100.0, c);
    const std::uint32_t repeated = a.step().repeated;
    EXPECT_EQ(b.step().repeated, 0u);
    EXPECT_EQ(c.step().repeated, repeated) << "the stacks do not begin again";
    EXPECT_GE(repeated, kRowBodies) << "the step did not begin again, so nothing was tested";
    EXPECT_EQ(repeated % kRowBodies, 0u);
    for (int k = 0; k < 20; ++k) {
      expectEqual(a, c, ", step " + std::to_string(k));
      expectEqual(b, c, ", step " + std::to_string(k));
      a.step(), b.step(), c.step();
    }
  }
}

// Impacts far away are none of its business either, at any setting. While they were at the fast ones, pairs whose
// predicted motions do not meet came to the solver in each step with an impact anywhere.
TEST(Impacts, ConcernNoBodiesThatAreFar) {
  for (const Fidelity fidelity : kFidelities) {
    SceneDef heap = onFloor(1.0 / 60.0, 0.5);
    heap.fidelity = fidelity;
    for (int k = 0; k < 8; ++k)
      heap.bodies.push_back(box("box_" + std::to_string(k), {0.2, 0.2, 0.2}, Vec3(0.0, 0.0, 0.1 + 0.2 * k)));
    // They fall beside an edge of the tower and beside each other: bounds overlap, and nothing touches.
    for (int k = 0; k < 3; ++k)
      heap.bodies.push_back(
          ball("ball_" + std::to_string(k), 0.1, Vec3(0.18 + 0.15 * k, 0.18 + 0.15 * k, 3.0)));
    SceneDef both = heap;
    for (int k = 0; k < 10; ++k)
      for (const double side : {-1.0, 1.0}) {
        both.bodies.push_back(ball("far_" + std::to_string(2 * k + (side > 0.0)), 0.1,
                                   Vec3(50.0 + side * (0.15 + 0.1 * k), 2.0 * k, 2.0)));
        both.bodies.back().twist.v_WB.x() = -side;
      }
    World alone(heap), together(both);
    std::uint32_t far = 0;
    for (int k = 0; k < 40; ++k) {
      const std::uint32_t own = alone.step().impacts;
      far += together.step().impacts - own;
      expectEqual(alone, together,
                  std::string(", ") + fidelityName(fidelity) + ", step " + std::to_string(k));
      if (testing::Test::HasFailure()) return;
    }
    EXPECT_GE(far, 10u) << fidelityName(fidelity);
  }
}

// Of two rows, one begins again more often than the other, or alone. Counts, impulses and warnings are those of
// both.
TEST_P(Restarts, OfSeveralGroupsAreIndependent) {
  const std::vector<double> speeds{100.0, 40.0, 0.0};
  SceneDef all = slope(GetParam());
  std::vector<World> alone;
  for (std::size_t r = 0; r < speeds.size(); ++r) {
    const std::string name = std::string(1, static_cast<char>('a' + r)) + "_";
    SceneDef one = slope(GetParam());
    addRow(name, 10.0 * r, one);
    addRow(name, 10.0 * r, all);
    alone.emplace_back(one);
  }
  World together(all);
  for (int k = 0; k < 3; ++k) {
    for (World& world : alone) world.step();
    together.step();
  }
  std::uint32_t repeated = 0, impacts = 0;
  std::vector<std::uint32_t> times;
  for (std::size_t r = 0; r < speeds.size(); ++r) {
    const std::string name = std::string(1, static_cast<char>('a' + r)) + "_";
    strike(name, 10.0 * r, speeds[r], alone[r]);
    strike(name, 10.0 * r, speeds[r], together);
    const StepReport& report = alone[r].step();
    repeated += report.repeated, impacts += report.impacts;
    times.push_back(report.repeated / kRowBodies);
  }
  EXPECT_GE(times[0], 1u);
  EXPECT_EQ(times[2], 0u);
  const StepReport& report = together.step();
  EXPECT_EQ(report.repeated, repeated);
  EXPECT_EQ(report.impacts, impacts);
  EXPECT_GE(impacts, 2u);
  for (std::size_t r = 0; r < speeds.size(); ++r) {
    expectEqual(alone[r], together, "");
    for (const char* which : {"0", "1", "2", "3", "striking", "beside", "next"}) {
      const std::string name = std::string(1, static_cast<char>('a' + r)) + "_" + which;
      EXPECT_EQ(impulsesOn(alone[r], name), impulsesOn(together, name)) << name;
    }
  }
}

// The striking ball rebounds and strikes another one behind it, which the broad phase did not find near
// anything. It begins again with the rest: it may not keep a velocity that nothing gives it. At the exact settings
// nothing has to.
TEST_P(Restarts, TakeAlongWhatAnImpactHasReached) {
  SceneDef scene = slope(GetParam());
  addRow("row_", 0.0, scene);
  World world(ordered(scene));
  for (int k = 0; k < 3; ++k) world.step();
  strike("row_", 0.0, 100.0, world);
  BodyEdit elastic;
  elastic.restitution = 1.0;
  world.editBody(world.find("row_striking"), elastic);
  BodyDef behind = ball("behind", 0.2, Vec3(-1.4, 0.0, 0.55));
  behind.material.friction = 0.0;
  behind.material.restitution = 1.0;
  world.addBody(behind);
  const Snapshot before = world.snapshot();
  const std::uint32_t repeated = world.step().repeated;
  if (GetParam() < Fidelity::Accurate) EXPECT_GE(repeated, kRowBodies + 1);
  const Vec3 v_W = stateOf(world, "behind").twist.v_WB;
  EXPECT_LT(v_W.x(), -1.0) << "it was struck";
  const double mass = (*before.bodies)[before.find("behind")].mass;
  const Vec3 gained = mass * (v_W - scene.gravity * scene.step);
  EXPECT_LE((gained - impulsesOn(world, "behind")).norm(), 1e-9 * gained.norm());
}

}  // namespace
}  // namespace rbs::test

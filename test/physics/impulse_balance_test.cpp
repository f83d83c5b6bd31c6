// SPDX-License-Identifier: BSD-3-Clause
// The impulses that a step reports, against what can be told from the motion alone: every body's momentum
// changes by its weight and by them.
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <ctime>
#include <map>
#include <random>
#include <set>
#include <tuple>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0;

// What the steps of a run have shown.
struct Observed {
  double worst = 0.0;  // imbalance, share of the impulses and the weight of the body
  std::string where;
  std::uint64_t impacts = 0, pushed = 0;  // impacts; bodies that some impulse pushed, by step
  std::uint64_t twice = 0;                // points that are listed twice
};

// Weight alone: what other effects do to a momentum cannot be told from the motion.
SceneDef withWeightAlone(SceneDef scene) {
  scene.air.reset();
  scene.wind.reset();
  scene.fluid.reset();
  scene.goal.reset();
  scene.effects[Effect::Sleeping] = false;
  return scene;
}

// What overlaps deeply is kept from gaining energy, which no contact does.
bool overlapsDeeply(const Snapshot& snapshot) {
  const auto length = [&](BodyId id) {
    const Vec3 size = fullExtents((*snapshot.bodies)[snapshot.find(id)].shape);
    return size.minCoeff() > 0.0 ? size.minCoeff() : std::numeric_limits<double>::infinity();
  };
  return std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), [&](const ContactPoint& point) {
    return point.separation < -0.05 * std::min(length(point.a), length(point.b));
  });
}

Observed follow(const SceneDef& scene, int steps, double seconds) {
  World world(scene);
  Observed run;
  const std::clock_t until = std::clock() + static_cast<std::clock_t>(seconds * CLOCKS_PER_SEC);
  Snapshot before = world.snapshot();
  for (int k = 0; k < steps && std::clock() < until; ++k) {
    run.impacts += world.step().impacts;
    const Snapshot after = world.snapshot();
    std::set<std::tuple<BodyId, BodyId, double, double, double>> places;
    for (const ContactPoint& p : after.contacts)
      run.twice += !places.emplace(p.a, p.b, p.p_W.x(), p.p_W.y(), p.p_W.z()).second;
    std::map<BodyId, Vec3> sum;
    std::map<BodyId, double> size;
    for (const ContactPoint& point : after.contacts) {
      EXPECT_GE(point.normal_impulse, 0.0);
      const Vec3 impulse = point.normal_impulse * point.n_W + point.friction_impulse;
      for (const auto& [body, sign] : {std::pair(point.a, -1.0), std::pair(point.b, 1.0)}) {
        sum.try_emplace(body, Vec3::Zero()).first->second += sign * impulse;
        size[body] += impulse.norm();
      }
    }
    const bool deep = overlapsDeeply(before) || overlapsDeeply(after);
    for (std::size_t i = 0; i < after.bodies->size() && !deep; ++i) {
      const BodyDescription& body = (*after.bodies)[i];
      if (body.kind != BodyKind::Dynamic) continue;
      const Vec3 &v0 = before.states[i].twist.v_WB, &v1 = after.states[i].twist.v_WB;
      const Vec3 given = body.mass * (v1 - v0 - scene.gravity * scene.step);
      const Vec3 told = sum.count(body.id) ? sum[body.id] : Vec3::Zero();
      run.pushed += size[body.id] > 0.0;
      const double scale =
          size[body.id] + body.mass * (scene.gravity.norm() * scene.step + v0.norm() + v1.norm());
      const double share = scale > 0.0 ? (told - given).norm() / scale : 0.0;
      if (share > run.worst) run.worst = share, run.where = body.name + " in step " + std::to_string(k + 1);
    }
    before = after;
  }
  return run;
}

class ImpulseBalance : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Settings, ImpulseBalance, testing::ValuesIn(kFidelities),
                         [](const auto& setting) { return std::string(fidelityName(setting.param)); });

TEST_P(ImpulseBalance, OfTheCatalogue) {
  std::uint64_t impacts = 0, pushed = 0;
  for (const SceneEntry& entry : listScenes(RBS_SCENES)) {
    SceneDef scene = withWeightAlone(readScene(findScene(RBS_SCENES, entry.name)).scene);
    scene.fidelity.preset = GetParam();
    const Observed run = follow(ordered(scene), 120, 1.0);
    EXPECT_LE(run.worst, 1e-11) << entry.name << ": " << run.where;
    EXPECT_EQ(run.twice, 0u) << entry.name;
    impacts += run.impacts, pushed += run.pushed;
  }
  EXPECT_GT(impacts, 100u);
  EXPECT_GT(pushed, 10000u);
}

// Impacts cut the step, faces tip over edges, and points come and go within a step and between its divisions.
TEST_P(ImpulseBalance, OfBodiesThatTumbleInABox) {
  std::mt19937_64 random(7);
  const auto any = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  for (const std::uint32_t divisions : {1u, 3u})
    for (const double restitution : {0.0, 0.6, 1.0}) {
      SceneDef scene = onFloor(kStep, 0.5);
      for (int k = 0; k < 9; ++k) {
        const std::string name = "body_" + std::to_string(k);
        const Vec3 place(0.9 * (k % 3), 0.9 * (k / 3), 0.6 + 0.2 * (k % 2));
        BodyDef body = k % 3 == 0 ? ball(name, 0.3, place) : box(name, Vec3(0.5, 0.4, 0.6), place);
        body.mass = any(0.5, 20.0);
        body.pose.q_WB = Quat(any(-1, 1), any(-1, 1), any(-1, 1), any(-1, 1)).normalized();
        body.twist = {Vec3(any(-3, 3), any(-3, 3), any(-6, 0)), Vec3(any(-5, 5), any(-5, 5), any(-5, 5))};
        body.material.restitution = restitution;
        scene.bodies.push_back(body);
      }
      scene.fidelity.preset = GetParam();
      scene.fidelity.divisions = divisions;
      const Observed run = follow(ordered(withWeightAlone(scene)), 60, 20.0);
      EXPECT_LE(run.worst, 1e-11) << "e = " << restitution << ", " << divisions
                                  << " divisions: " << run.where;
      EXPECT_EQ(run.twice, 0u);
      EXPECT_GT(run.pushed, 30u);
    }
}

// A block comes down on a plate with one of its edges, and pushes it into the floor. The plane itself stops the plate at half
// of its thickness, and their contact reports that impulse.
TEST_P(ImpulseBalance, OfWhatAPlaneStops) {
  double stopped = 0.0;  // change of a speed by the plane itself, m/s
  for (const double speed : {10.0, 30.0, 100.0}) {
    SceneDef scene = onFloor(kStep, 0.3);
    scene.fidelity.preset = GetParam();
    scene.bodies.push_back(box("plate", {1.0, 1.0, 0.1}, {0.0, 0.0, 0.05}));
    scene.bodies.push_back(box("block", {2.0, 2.0, 2.0}, {0.9, 0.0, 1.1001}));
    scene.bodies.back().density = 1e5;
    scene.bodies.back().twist = {{0.0, 0.0, -speed}, {speed, 0.5 * speed, 0.0}};
    World world(ordered(scene));
    const double mass = (*world.snapshot().bodies)[world.snapshot().find("plate")].mass;
    for (int k = 0; k < 20; ++k) {
      const Vec3 before = stateOf(world, "plate").twist.v_WB;
      world.step();
      const Snapshot now = world.snapshot();
      Vec3 reported = Vec3::Zero();
      double size = 0.0;
      bool lifted = false;
      for (const ContactPoint& point : now.contacts) {
        if (point.a != world.find("plate") && point.b != world.find("plate")) continue;
        const Vec3 impulse = point.normal_impulse * point.n_W + point.friction_impulse;
        reported += (point.b == world.find("plate") ? 1.0 : -1.0) * impulse;
        size += impulse.norm();
        const bool by_floor = point.a == world.find("floor") || point.b == world.find("floor");
        if (!by_floor || std::abs(point.separation + 0.05) > 1e-9 || point.normal_impulse == 0.0) continue;
        lifted = true, stopped = std::max(stopped, point.normal_impulse / mass);
      }
      if (!lifted) continue;  // what overlaps deeply is kept from gaining energy, which no contact does
      const Vec3 given = mass * (stateOf(world, "plate").twist.v_WB - before - scene.gravity * kStep);
      EXPECT_LE((reported - given).norm(), 1e-9 * size) << speed << " m/s, step " << k;
    }
  }
  if (GetParam() == Fidelity::Preview) EXPECT_GT(stopped, 0.2);
}

// The weight of what sleeps is what its contacts report.
TEST(ImpulsesAsleep, CarryTheWeight) {
  SceneDef scene = onFloor(kStep, 0.0);
  scene.bodies.push_back(box("crate", Vec3(1.0, 1.0, 1.0), Vec3(0.0, 0.0, 0.5)));
  scene.bodies.back().mass = 10.0;
  scene.effects[Effect::Sleeping] = true;
  for (const std::uint32_t divisions : {1u, 4u}) {
    scene.fidelity.divisions = divisions;
    World world(scene);
    for (int k = 0; k < 120; ++k) {
      world.step();
      double sum = 0.0;
      for (const ContactPoint& point : world.snapshot().contacts) sum += point.normal_impulse;
      if (k > 10) EXPECT_NEAR(sum, 10.0 * kGravity * kStep, 1e-3 * 10.0 * kGravity * kStep) << k;
    }
    EXPECT_TRUE(stateOf(world, "crate").twist.v_WB.isZero(0.0));
  }
}

}  // namespace
}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// Rays, closest points and overlaps in a world.
#include "rigid_body_sim/queries.h"

#include "core/narrowphase_oracles.h"
#include "make_scene.h"
#include "narrowphase/collide.h"
#include "narrowphase/ray_cast.h"
#include "rigid_body_sim/simulator.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

using namespace rbs;
using namespace rbs::test;
using rbs::oracle::Random;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();

std::string nameOf(const Snapshot& snapshot, BodyId id) {
  return (*snapshot.bodies)[snapshot.find(id)].name;
}

BodyId idOf(const Snapshot& snapshot, const std::string& name) {
  return snapshot.states[snapshot.find(name)].id;
}

// A ball of radius 1 at the origin, a cube of size 2 at x = 5, a wall at x = 10 that looks back, all on the x
// axis.
Snapshot threeInARow() {
  SceneDef scene = emptySpace(0.01);
  scene.bodies = {ball("ball", 1.0, Vec3::Zero()), box("box", Vec3::Constant(2.0), {5, 0, 0}),
                  body("wall", Plane{}, {10, 0, 0})};
  scene.bodies[2].kind = BodyKind::Static;
  scene.bodies[2].pose.q_WB = Quat(Eigen::AngleAxisd(-kPi / 2, Vec3::UnitY()));
  return World(scene).snapshot();
}

SceneDef crowd(Random& random, int n) {
  SceneDef scene = emptySpace(0.01);
  for (int k = 0; k < n; ++k) {
    const Shape shape = k % 2 ? Shape(Sphere{random.uniform(0.05, 1.0)}) : Shape(random.box());
    scene.bodies.push_back(body("body_" + std::to_string(k), shape, Vec3::Zero()));
    scene.bodies.back().pose = random.pose(4.0);
  }
  scene.bodies.push_back(body("wall", Plane{}, {0, 0, -3}));
  scene.bodies.back().kind = BodyKind::Static;
  return scene;
}

void expectRefused(const std::string& path, const std::function<void()>& question) {
  try {
    question();
    ADD_FAILURE() << path << " was not refused";
  } catch (const InvalidInput& refusal) {
    EXPECT_EQ(refusal.problems().front().path, path);
    EXPECT_FALSE(refusal.problems().front().value.empty());
    EXPECT_FALSE(refusal.problems().front().allowed.empty());
  }
}

TEST(Queries, ARayMeetsTheNearestBodyAndWithoutItTheNext) {
  const Snapshot snapshot = threeInARow();
  Ray ray;
  ray.origin_W = {-3, 0.5, 0};
  ray.direction_W = {1e-200, 0, 0};
  auto hit = castRay(snapshot, ray);
  ASSERT_TRUE(hit);
  EXPECT_EQ(nameOf(snapshot, hit->body), "ball");
  EXPECT_DOUBLE_EQ(hit->distance, 3.0 - std::sqrt(0.75));
  EXPECT_TRUE(hit->p_W.isApprox(Vec3(-std::sqrt(0.75), 0.5, 0), 1e-15));
  EXPECT_TRUE(hit->n_W.isApprox(Vec3(-std::sqrt(0.75), 0.5, 0), 1e-15));

  ray.ignore = {hit->body};
  hit = castRay(snapshot, ray);
  ASSERT_TRUE(hit);
  EXPECT_EQ(nameOf(snapshot, hit->body), "box");
  EXPECT_DOUBLE_EQ(hit->distance, 7.0);
}

TEST(Queries, ARayThroughTheWorldMeetsAllBodiesInOrder) {
  const Snapshot snapshot = threeInARow();
  Ray ray;
  ray.origin_W = {-3, 0, 0};
  ray.direction_W = {5, 0, 0};
  const auto hits = castRayThrough(snapshot, ray);
  ASSERT_EQ(hits.size(), 3u);
  const char* names[] = {"ball", "box", "wall"};
  const double distances[] = {2.0, 7.0, 13.0};
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(nameOf(snapshot, hits[k].body), names[k]);
    EXPECT_DOUBLE_EQ(hits[k].distance, distances[k]);
    EXPECT_TRUE(hits[k].n_W.isApprox(-Vec3::UnitX(), 1e-15));
  }
  ray.max_distance = 7.0;
  EXPECT_EQ(castRayThrough(snapshot, ray).size(), 2u);
  ray.max_distance = 1.9;
  EXPECT_FALSE(castRay(snapshot, ray));
}

TEST(Queries, ABodyThatHoldsTheOriginIsHitThere) {
  const Snapshot snapshot = threeInARow();
  Ray ray;
  ray.origin_W = {5.5, 0.2, 0.3};
  ray.direction_W = {0, 3, 4};
  const auto hit = castRay(snapshot, ray);
  ASSERT_TRUE(hit);
  EXPECT_EQ(nameOf(snapshot, hit->body), "box");
  EXPECT_EQ(hit->distance, 0.0);
  EXPECT_EQ(hit->p_W, ray.origin_W);
  EXPECT_TRUE(hit->n_W.isApprox(Vec3(0, -0.6, -0.8), 1e-15));
}

// Body by body, without bounds.
TEST(Queries, NoBodyOnTheRayIsMissed) {
  const std::uint64_t seed = 71;
  Random random(seed);
  int hits = 0;
  for (int world = 0; world < 20; ++world) {
    const Snapshot snapshot = World(crowd(random, 60)).snapshot();
    for (int k = 0; k < 200; ++k) {
      Ray ray;
      ray.origin_W = random.inCube(8.0);
      ray.direction_W = random.uniform(0.1, 10.0) * random.direction();
      if (k % 2) ray.max_distance = random.uniform(0.1, 10.0);
      std::size_t expected = 0;
      double nearest = kInfinity;
      for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
        const Pose& pose = snapshot.states[i].pose;
        const auto entry =
            castRay((*snapshot.bodies)[i].shape, pose.q_WB.conjugate() * (ray.origin_W - pose.p_WB),
                    pose.q_WB.conjugate() * ray.direction_W.normalized());
        if (!entry || entry->distance > ray.max_distance) continue;
        ++expected;
        nearest = std::min(nearest, entry->distance);
      }
      const auto all = castRayThrough(snapshot, ray);
      const auto first = castRay(snapshot, ray);
      ASSERT_EQ(all.size(), expected) << "seed " << seed << ", world " << world << ", ray " << k;
      ASSERT_EQ(first.has_value(), expected > 0);
      if (!first) continue;
      ++hits;
      ASSERT_NEAR(first->distance, nearest, 1e-14 * (10.0 + nearest))
          << "seed " << seed << ", world " << world << ", ray " << k;
      ASSERT_EQ(first->body, all.front().body);
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(Queries, ClosestPointsSpanTheGap) {
  const Snapshot snapshot = threeInARow();
  const auto of = [&](const char* a, const char* b) {
    return closestPoints(snapshot, idOf(snapshot, a), idOf(snapshot, b));
  };
  ClosestPoints found = of("ball", "box");
  EXPECT_DOUBLE_EQ(found.distance, 3.0);
  EXPECT_TRUE(found.n_W.isApprox(Vec3::UnitX()));
  EXPECT_TRUE(found.p_WA.isApprox(Vec3(1, 0, 0)));
  EXPECT_TRUE(found.p_WB.isApprox(Vec3(4, 0, 0)));
  found = of("wall", "box");
  EXPECT_DOUBLE_EQ(found.distance, 4.0);
  EXPECT_TRUE(found.n_W.isApprox(-Vec3::UnitX()));
  EXPECT_DOUBLE_EQ(found.p_WA.x(), 10.0);
  EXPECT_DOUBLE_EQ(found.p_WB.x(), 6.0);
}

TEST(Queries, OverlapsAreThoseOfAllBodiesOneByOne) {
  const std::uint64_t seed = 72;
  Random random(seed);
  std::size_t total = 0;
  for (int world = 0; world < 20; ++world) {
    const Snapshot snapshot = World(crowd(random, 60)).snapshot();
    for (int k = 0; k < 50; ++k) {
      const Shape shape = k % 3 == 0 ? Shape(Plane{}) : k % 3 == 1 ? Shape(random.box()) : Shape(Sphere{0.7});
      const Pose pose = random.pose(4.0);
      const double margin = k % 2 ? 0.3 : 0.0;
      std::vector<Neighbour> expected;
      for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
        const double distance =
            gap(shape, pose, (*snapshot.bodies)[i].shape, snapshot.states[i].pose).distance;
        if (distance <= margin) expected.push_back({snapshot.states[i].id, distance});
      }
      const std::vector<Neighbour> found = overlaps(snapshot, shape, pose, margin);
      ASSERT_EQ(found.size(), expected.size()) << "seed " << seed << ", world " << world << ", place " << k;
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].body, expected[i].body)
            << "seed " << seed << ", world " << world << ", place " << k;
        ASSERT_NEAR(found[i].distance, expected[i].distance, 1e-14);
      }
      total += found.size();
    }
  }
  EXPECT_GT(total, 1000u);
}

TEST(Queries, BadQuestionsAreRefusedWithTheReason) {
  const Snapshot snapshot = threeInARow();
  const auto ask = [&](const Vec3& origin, const Vec3& direction, double max_distance) {
    return [=] {
      Ray ray;
      ray.origin_W = origin;
      ray.direction_W = direction;
      ray.max_distance = max_distance;
      castRay(snapshot, ray);
      castRayThrough(snapshot, ray);
    };
  };
  const Vec3 zero = Vec3::Zero(), x = Vec3::UnitX();
  expectRefused("direction", ask(zero, zero, 1.0));
  expectRefused("direction", ask(zero, {kNan, 1, 0}, 1.0));
  expectRefused("direction", ask(zero, {kInfinity, 1, 0}, 1.0));
  expectRefused("origin", ask({0, kNan, 0}, x, 1.0));
  expectRefused("origin", ask({0, 1e30, 0}, x, 1.0));
  expectRefused("max_distance", ask(zero, x, 0.0));
  expectRefused("max_distance", ask(zero, x, -1.0));
  expectRefused("max_distance", ask(zero, x, kNan));

  const BodyId ball_id = idOf(snapshot, "ball"), wall = idOf(snapshot, "wall");
  expectRefused("body_a", [&] { closestPoints(snapshot, BodyId{77}, wall); });
  expectRefused("body_b", [&] { closestPoints(snapshot, wall, BodyId{}); });
  expectRefused("body_b", [&] { closestPoints(snapshot, ball_id, ball_id); });
  SceneDef two_walls = emptySpace(0.01);
  two_walls.bodies = {body("a", Plane{}, zero), body("b", Plane{}, zero)};
  for (BodyDef& plane : two_walls.bodies) plane.kind = BodyKind::Static;
  const Snapshot planes = World(two_walls).snapshot();
  expectRefused("body_b", [&] { closestPoints(planes, idOf(planes, "a"), idOf(planes, "b")); });

  expectRefused("place.size", [&] { overlaps(snapshot, Sphere{-1.0}, {}); });
  expectRefused("place.position", [&] {
    overlaps(snapshot, Sphere{}, {Vec3(kNan, 0, 0), Quat::Identity()});
  });
  expectRefused("place.orientation", [&] { overlaps(snapshot, Sphere{}, {zero, Quat(0, 0, 0, 0)}); });
  expectRefused("margin", [&] { overlaps(snapshot, Sphere{}, {}, -0.1); });
  expectRefused("margin", [&] { overlaps(snapshot, Sphere{}, {}, kNan); });
}

TEST(Queries, AskedWhileTheSimulationRunsTheyChangeNothing) {
  Random random(73);
  SceneDef scene = crowd(random, 30);
  scene.gravity = {0, 0, -9.81};
  World alone(scene);
  for (int k = 0; k < 300; ++k) alone.step();

  int asked = 0;
  Simulator simulator(scene, {true, 1.0});
  std::atomic<bool> done{false};
  std::thread asking([&] {
    while (!done || asked < 100) {
      const auto snapshot = simulator.snapshot();
      Ray ray;
      ray.origin_W = {0, 0, 10};
      ray.direction_W = random.direction();
      castRayThrough(*snapshot, ray);
      closestPoints(*snapshot, snapshot->states[0].id, snapshot->states[1].id);
      overlaps(*snapshot, Sphere{3.0}, {});
      ++asked;
    }
  });
  simulator.step(300);
  done = true;
  asking.join();
  EXPECT_EQ(simulator.snapshot()->hash, alone.stateHash());
}

}  // namespace

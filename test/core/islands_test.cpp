// SPDX-License-Identifier: BSD-3-Clause
// The constraint graph: which bodies make an island, whatever kind of constraint connects them.
#include "step/islands.h"
#include "make_scene.h"
#include "step/analyse_scene.h"
#include "step/sleep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

using namespace rbs;
using namespace rbs::test;

namespace {

// A kind that the program does not have: a gear between two joints, say, which ties four bodies.
constexpr auto kGear = static_cast<ConstraintKind>(1);

struct World {
  SceneStore scene;
  StepStore step;
  SceneAnalysis analysis;
  Context context{scene, step, analysis};

  explicit World(const std::vector<bool>& dynamic) {
    for (std::size_t k = 0; k < dynamic.size(); ++k) {
      BodyDef def = ball("ball_" + std::to_string(k), 0.5, Vec3(0.2 * static_cast<double>(k), 0.0, 0.0));
      if (!dynamic[k]) def.kind = BodyKind::Static;
      scene.bodies.append(BodyId{k + 1}, def);
    }
    analysis = analyseScene(scene);
    step.begin(scene, 0.0, 0.01);
  }
};

// By brute force: dynamic bodies that edges connect get one colour.
std::vector<Index> colours(const std::vector<bool>& dynamic, const std::vector<Edge>& edges) {
  std::vector<Index> colour(dynamic.size());
  for (Index i = 0; i < colour.size(); ++i) colour[i] = dynamic[i] ? i : kNone;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Edge& edge : edges)
      for (const Index a : edge.bodies)
        for (const Index b : edge.bodies)
          if (a != kNone && b != kNone && dynamic[a] && dynamic[b] && colour[a] < colour[b])
            colour[b] = colour[a], changed = true;
  }
  return colour;
}

TEST(Islands, AreTheConnectedPartsOfTheGraph) {
  std::mt19937 random(1);
  for (int run = 0; run < 300; ++run) {
    std::vector<bool> dynamic(12);
    for (std::size_t k = 0; k < dynamic.size(); ++k) dynamic[k] = random() % 4 != 0;
    std::vector<Edge> edges;
    for (Index k = random() % 10; k > 0; --k) {
      std::vector<Index> bodies(dynamic.size());
      std::iota(bodies.begin(), bodies.end(), 0u);
      std::shuffle(bodies.begin(), bodies.end(), random);
      Edge edge{random() % 2 ? kGear : ConstraintKind::Contact, k, {}};
      const std::size_t size = edge.kind == kGear ? 1 + random() % 4 : 2;
      for (std::size_t b = 0; b < 4; ++b) edge.bodies[b] = b < size ? bodies[b] : kNone;
      edges.push_back(edge);
    }
    World world(dynamic);
    islands::connect(world.context, world.context.scene.lists.in_islands, edges);

    const std::vector<Index> expected = colours(dynamic, edges);
    std::size_t listed = 0, connected = 0;
    Index last_first = 0;
    for (Index k = 0; k < world.step.islands.size(); ++k) {
      const Island& island = world.step.islands[k];
      ASSERT_TRUE(std::is_sorted(island.bodies.begin(), island.bodies.end()));
      ASSERT_TRUE(k == 0 || last_first < island.bodies.front()) << "in the order of their first bodies";
      last_first = island.bodies.front();
      for (const Index i : island.bodies) {
        ASSERT_EQ(expected[i], island.bodies.front());
        ASSERT_EQ(world.step.island[i], k);
      }
      ASSERT_TRUE(std::none_of(island.edges.begin(), island.edges.end(), [](const Edge& edge) {
        return edge.kind == ConstraintKind::Contact;
      })) << "contacts have a list of their own";
      for (const Edge& edge : island.edges)
        ASSERT_TRUE(std::any_of(edge.bodies.begin(), edge.bodies.end(),
                                [&](Index i) { return i != kNone && world.step.island[i] == k; }));
      listed += island.bodies.size(), connected += island.constraints();
    }
    ASSERT_EQ(listed, static_cast<std::size_t>(std::count(dynamic.begin(), dynamic.end(), true)));
    const auto moves = [&](const Edge& edge) {
      return std::any_of(edge.bodies.begin(), edge.bodies.end(),
                         [&](Index i) { return i != kNone && dynamic[i]; });
    };
    ASSERT_EQ(connected, static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), moves)));
  }
}

TEST(Islands, ThatAreMergedKeepAllBodiesAndEdges) {
  World world({true, true, true, true});
  islands::connect(world.context, world.context.scene.lists.in_islands,
                   {{ConstraintKind::Contact, 0, {0, 1, kNone, kNone}}, {kGear, 0, {2, 3, kNone, kNone}}});
  ASSERT_EQ(world.step.islands.size(), 2u);
  EXPECT_EQ(islands::merge(world.context, 1, 0), 0u);
  EXPECT_EQ(world.step.islands[0].bodies, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(world.step.islands[0].contacts, std::vector<Index>{0});
  EXPECT_EQ(world.step.islands[0].edges.size(), 1u);
  EXPECT_TRUE(world.step.islands[1].bodies.empty() && world.step.islands[1].flies());
  for (Index i = 0; i < 4; ++i) EXPECT_EQ(world.step.island[i], 0u);
}

// Of two islands that have become one in the step the other is empty, and no group to put to sleep.
TEST(Islands, WithoutBodiesDoNotFallAsleep) {
  World world({true, true});
  islands::connect(world.context, {0, 1}, {});
  ASSERT_EQ(world.step.islands.size(), 2u);
  islands::merge(world.context, 0, 1);
  world.step.before.resize(2), world.step.twist_before.resize(2);
  world.scene.settings.gravity = world.scene.gravity_W = Vec3(0.0, 0.0, -10.0);
  for (int k = 0; k < 100; ++k) {
    world.step.falling_asleep.clear();
    sleep::update(world.context);
  }
  ASSERT_EQ(world.step.falling_asleep.size(), 1u);
  EXPECT_EQ(world.step.falling_asleep[0], (std::vector<Index>{0, 1}));
}

}  // namespace

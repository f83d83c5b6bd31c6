// SPDX-License-Identifier: BSD-3-Clause
// A kept separating axis changes no answer of the narrow phase, bit for bit, and saves most of its searches.
#include "core/hard_pairs.h"
#include "make_scene.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rbs {
namespace {

using oracle::Pair;
using oracle::Random;

const std::vector<std::string> kKinds{"sphere", "box", "capsule", "cylinder", "cone", "hull"};

bool isClosedForm(const std::string& a, const std::string& b) {
  const auto is = [&](const char* x, const char* y) { return (a == x && b == y) || (a == y && b == x); };
  return is("box", "box") || is("capsule", "capsule") ||
         ((a == "sphere" || b == "sphere") && a != "hull" && b != "hull");
}

void expectSame(const Manifold& a, const Manifold& b, const std::string& where) {
  ASSERT_EQ(a.size, b.size) << where;
  if (a.size == 0) return;
  ASSERT_EQ(a.n_W, b.n_W) << where;
  for (int k = 0; k < a.size; ++k) {
    ASSERT_EQ(a.points[k].p_W, b.points[k].p_W) << where;
    ASSERT_EQ(a.points[k].separation, b.points[k].separation) << where;
    ASSERT_EQ(a.points[k].feature, b.points[k].feature) << where;
  }
}

// The pair, by a time along a slow path, with margins of any size.
struct Walk {
  Pair pair;
  Vec3 v_W, w_W;
  double margin;

  Walk(Random& random, const std::string& a, const std::string& b) : pair(randomPair(random, a, b)) {
    const double size = oracle::sizeOf(pair);
    pair.X_WB.p_WB += size * random.uniform(0.0, 0.3) * (pair.X_WB.p_WB - pair.X_WA.p_WB).normalized();
    v_W = random.uniform(0.0, 0.02) * size * random.direction();
    w_W = random.uniform(0.0, 0.05) * random.direction();
    margin = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 0.1) * size;
  }
  void advance() {
    pair.X_WB.p_WB += v_W;
    pair.X_WB.q_WB = (rotationBy(w_W) * pair.X_WB.q_WB).normalized();
  }
};

TEST(SeparatingAxis, ChangesNoAnswer) {
  Random random(11);
  for (const std::string& a : kKinds)
    for (const std::string& b : kKinds) {
      SeparatingAxis of_manifold, of_within;
      int apart = 0;
      for (int k = 0; k < 60; ++k) {
        Walk walk(random, a, b);
        // Now and then an axis that has nothing to do with the pair.
        if (k % 5 == 0) of_manifold.n_A = of_within.n_A = random.direction();
        for (int step = 0; step < 8; ++step, walk.advance()) {
          const auto& [shape_a, shape_b, X_WA, X_WB] = walk.pair;
          const std::string where =
              a + ", " + b + ", walk " + std::to_string(k) + ", step " + std::to_string(step);
          const Manifold searched = collide(shape_a, X_WA, shape_b, X_WB, walk.margin);
          expectSame(collide(shape_a, X_WA, shape_b, X_WB, walk.margin, of_manifold), searched, where);
          const SeparatingAxis known = of_manifold;
          SeparatingAxis unknown;
          ASSERT_EQ(collide(shape_a, X_WA, shape_b, X_WB, walk.margin, unknown).n_W,
                    collide(shape_a, X_WA, shape_b, X_WB, walk.margin, of_manifold).n_W)
              << where;  // also without points: what reads the normal has equal bits
          of_manifold = known;
          ASSERT_EQ(areWithin(shape_a, X_WA, shape_b, X_WB, walk.margin, of_within),
                    areWithin(shape_a, X_WA, shape_b, X_WB, walk.margin))
              << where;
          apart += searched.size == 0;
        }
      }
      for (const SeparatingAxis* axis : {&of_manifold, &of_within}) {
        if (isClosedForm(a, b)) {
          EXPECT_EQ(axis->queries, 0u) << a << ", " << b;
        } else {
          EXPECT_EQ(axis->queries, 480u) << a << ", " << b;
          EXPECT_GT(axis->kept, 0.6 * apart)
              << a << ", " << b << ": of " << apart << " queries that are apart";
        }
      }
    }
}

// What lies within the margin, by however little, is not separated.
TEST(SeparatingAxis, SeparatesNoPairWithinTheMargin) {
  Random random(12);
  for (int k = 0; k < 3000; ++k) {
    const std::string& a = kKinds[random.below(6)];
    const std::string& b = kKinds[random.below(6)];
    const Pair pair = randomPair(random, a, b);
    const Gap gap = rbs::gap(pair.a, pair.X_WA, pair.b, pair.X_WB);
    if (gap.distance <= 0.0) continue;
    SeparatingAxis axis;
    axis.set(pair.X_WA, gap.n_W);
    EXPECT_FALSE(axis.separates(pair.a, pair.X_WA, pair.b, pair.X_WB, gap.distance)) << a << ", " << b;
    axis.n_A = random.direction();
    EXPECT_FALSE(axis.separates(pair.a, pair.X_WA, pair.b, pair.X_WB, gap.distance)) << a << ", " << b;
  }
}

SceneDef heap(bool balls) {
  SceneDef scene = test::onFloor(1.0 / 60.0, 0.5);
  for (int k = 0; k < 24; ++k) {
    const Shape shape = balls   ? Shape(Sphere{0.2})
                        : k % 2 ? Shape(Cylinder{0.2, 0.2})
                                : Shape(Cone{0.2, 0.4});
    scene.bodies.push_back(
        test::body("body_" + std::to_string(k), shape,
                   {0.35 * (k % 3) + 0.01 * (k % 7), 0.35 * (k / 3 % 3), 0.4 + 0.45 * (k / 9)}));
    scene.bodies.back().pose.q_WB = rotationBy(Vec3(0.3 * k, 0.2 * k, 0.1));
  }
  return scene;
}

TEST(SeparatingAxis, IsKeptWithTheContactAndCounted) {
  for (const Fidelity fidelity : {Fidelity::Interactive, Fidelity::Accurate}) {
    SceneDef scene = heap(false);
    scene.fidelity = fidelity;
    World world(scene);
    std::uint64_t queries = 0, kept = 0;
    for (int k = 0; k < 40; ++k) {
      const StepReport& report = world.step();
      queries += report.axis_queries, kept += report.axes_kept;
    }
    EXPECT_GT(queries, 1000u) << fidelityName(fidelity);
    EXPECT_GT(kept, queries / 5) << fidelityName(fidelity) << ": of " << queries;
  }
  World world(heap(true));
  for (int k = 0; k < 30; ++k) EXPECT_EQ(world.step().axis_queries, 0u);
}

}  // namespace
}  // namespace rbs

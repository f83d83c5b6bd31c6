// SPDX-License-Identifier: BSD-3-Clause
// What holds for every pair of shapes: order, place, scale and far-off origins do not matter.
#include "narrowphase/collide.h"

#include "core/narrowphase_oracles.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::moved;
using oracle::Random;

Shape randomShape(Random& random) {
  switch (random.below(3)) {
    case 0:
      return Sphere{random.uniform(0.1, 1.0)};
    case 1:
      return random.box();
    default:
      return Plane{};
  }
}

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
  std::string where;
};

Pair randomPair(Random& random, std::uint64_t seed, int k) {
  return {randomShape(random), randomShape(random), random.pose(0.6), random.pose(0.6),
          "seed " + std::to_string(seed) + ", pair " + std::to_string(k)};
}

// How far a point is outside of a shape (negative: inside).
double outside(const Shape& shape, const Pose& pose, const Vec3& p_W) {
  const oracle::Vec q = oracle::PlacedBox(Box{}, pose).toBody(p_W.cast<oracle::Real>());
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return static_cast<double>(q.norm() - sphere->radius);
  if (std::holds_alternative<Plane>(shape)) return static_cast<double>(q.z());
  const oracle::Vec beyond = q.cwiseAbs() - 0.5L * std::get<Box>(shape).size.cast<oracle::Real>();
  const oracle::Real out = beyond.cwiseMax(0.0L).norm();
  return static_cast<double>(out > 0.0L ? out : beyond.maxCoeff());
}

TEST(Collide, ThePointsOfAGapLieOnBothSurfacesAndSpanIt) {
  const std::uint64_t seed = 50;
  Random random(seed);
  int overlaps = 0;
  for (int k = 0; k < 20000; ++k) {
    Pair p = randomPair(random, seed, k);
    if (k % 3 == 0) p.X_WB.q_WB = p.X_WA.q_WB;  // faces and edges parallel
    if (std::holds_alternative<Plane>(p.a) && std::holds_alternative<Plane>(p.b)) continue;
    const Gap found = gap(p.a, p.X_WA, p.b, p.X_WB);
    overlaps += found.distance < 0.0;
    ASSERT_NEAR((found.p_WB - found.p_WA - found.distance * found.n_W).norm(), 0.0, 1e-14) << p.where;
    ASSERT_NEAR(outside(p.a, p.X_WA, found.p_WA), 0.0, 1e-13) << p.where;
    ASSERT_NEAR(outside(p.b, p.X_WB, found.p_WB), 0.0, 1e-13) << p.where;
  }
  EXPECT_GT(overlaps, 2000);
}

TEST(Collide, SwappingTurnsTheNormal) {
  const std::uint64_t seed = 51;
  Random random(seed);
  for (int k = 0; k < 10000; ++k) {
    const Pair p = randomPair(random, seed, k);
    const Gap ab = gap(p.a, p.X_WA, p.b, p.X_WB), ba = gap(p.b, p.X_WB, p.a, p.X_WA);
    if (std::isinf(ab.distance)) {
      ASSERT_EQ(ba.distance, ab.distance) << p.where;
      ASSERT_EQ(collide(p.a, p.X_WA, p.b, p.X_WB, 10.0).size, 0) << p.where;
      continue;
    }
    ASSERT_NEAR(ab.distance, ba.distance, 1e-13) << p.where;
    ASSERT_TRUE(ab.n_W.isApprox(-ba.n_W, 1e-7)) << p.where;
    const bool touch = collide(p.a, p.X_WA, p.b, p.X_WB, 0.05).size > 0;
    ASSERT_EQ(touch, collide(p.b, p.X_WB, p.a, p.X_WA, 0.05).size > 0) << p.where;
    if (std::abs(ab.distance - 0.05) > 1e-12) {
      ASSERT_EQ(touch, ab.distance < 0.05) << p.where;
    }
  }
}

TEST(Collide, RigidMotionMovesTheManifold) {
  const std::uint64_t seed = 52;
  Random random(seed);
  int same = 0, all = 0;
  for (int k = 0; k < 10000; ++k) {
    const Pair p = randomPair(random, seed, k);
    const Pose by{random.inCube(100.0), random.orientation()};
    const Manifold one = collide(p.a, p.X_WA, p.b, p.X_WB, 0.05);
    const Manifold other = collide(p.a, moved(by, p.X_WA), p.b, moved(by, p.X_WB), 0.05);
    const double one_gap = gap(p.a, p.X_WA, p.b, p.X_WB).distance;
    const double other_gap = gap(p.a, moved(by, p.X_WA), p.b, moved(by, p.X_WB)).distance;
    if (!std::isinf(one_gap)) {
      ASSERT_NEAR(other_gap, one_gap, 1e-12) << p.where;
    }
    if (one.size == 0) continue;
    ++all;
    if (one.size != other.size || !other.n_W.isApprox(by.q_WB * one.n_W, 1e-9)) continue;
    ++same;
    for (int i = 0; i < one.size; ++i) {
      ASSERT_EQ(one.points[i].feature, other.points[i].feature) << p.where;
      ASSERT_NEAR(one.points[i].separation, other.points[i].separation, 1e-11) << p.where;
      ASSERT_LE((by.p_WB + by.q_WB * one.points[i].p_W - other.points[i].p_W).norm(), 1e-10) << p.where;
    }
  }
  EXPECT_GT(same, 0.999 * all);
}

TEST(Collide, ScaleChangesNothingButLengths) {
  const std::uint64_t seed = 53;
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    const Pair p = randomPair(random, seed, k);
    const Manifold one = collide(p.a, p.X_WA, p.b, p.X_WB, 0.05);
    for (const int exponent : {-20, 20}) {  // about 1e-6 and 1e6; powers of two round alike
      const double scale = std::ldexp(1.0, exponent);
      const Manifold other = collide(scaled(p.a, scale), {scale * p.X_WA.p_WB, p.X_WA.q_WB},
                                     scaled(p.b, scale), {scale * p.X_WB.p_WB, p.X_WB.q_WB}, scale * 0.05);
      ASSERT_EQ(other.size, one.size) << p.where;
      ASSERT_EQ(other.n_W, one.n_W) << p.where;
      for (int i = 0; i < one.size; ++i) {
        ASSERT_EQ(other.points[i].separation, scale * one.points[i].separation) << p.where;
        ASSERT_EQ(other.points[i].p_W, scale * one.points[i].p_W) << p.where;
        ASSERT_EQ(other.points[i].feature, one.points[i].feature) << p.where;
      }
    }
  }
}

// Hard case A50: cubes stacked far away, to the rounding of the coordinates.
TEST(Collide, FarFromTheOrigin) {
  const Box cube{Vec3::Ones()};
  for (const double far : {1e3, 1e5, 1e7}) {
    const Pose below{Vec3(far, -far, far), Quat::Identity()};
    const Pose above{below.p_WB + Vec3(0.25, 0.125, 1.0 - 0x1p-10), Quat::Identity()};
    const Manifold manifold = collide(cube, below, cube, above, 0.0);
    ASSERT_EQ(manifold.size, 4) << far;
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(manifold.points[k].separation, -0x1p-10, 1e-15 * far) << far;
  }
}

TEST(Collide, BoxOnPlaneTouchesWithItsCorners) {
  const Box box{Vec3(1, 2, 3)};
  const Pose floor{Vec3(5, 5, 1), Quat::Identity()};
  const Manifold flat = collide(box, {Vec3(0, 0, 2.495), Quat::Identity()}, Plane{}, floor, 0.01);
  ASSERT_EQ(flat.size, 4);
  EXPECT_EQ(flat.n_W, Vec3(-Vec3::UnitZ()));
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(flat.points[k].separation, -0.005, 1e-15);
    EXPECT_NEAR(flat.points[k].p_W.z(), 0.9975, 1e-15);
  }
  EXPECT_EQ(collide(box, {Vec3(0, 0, 2.52), Quat::Identity()}, Plane{}, floor, 0.01).size, 0);
  EXPECT_EQ(collide(box, {Vec3(0, 0, -9), Quat::Identity()}, Plane{}, floor, 0.01).size, 8);

  const std::uint64_t seed = 54;
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    const Pose X_WA = random.pose(1.0), X_WB = random.pose(1.0);
    const oracle::PlacedBox placed(box, X_WA);
    const oracle::Vec up = oracle::PlacedBox(box, X_WB).R.col(2);
    oracle::Real lowest = 1e9L;
    int touching = 0;
    for (int c = 0; c < 8; ++c) {
      const oracle::Real height = up.dot(placed.corner(c) - X_WB.p_WB.cast<oracle::Real>());
      lowest = std::min(lowest, height);
      touching += height <= 0.1L;
    }
    ASSERT_NEAR(gap(box, X_WA, Plane{}, X_WB).distance, static_cast<double>(lowest), 1e-14)
        << "seed " << seed;
    ASSERT_EQ(collide(box, X_WA, Plane{}, X_WB, 0.1).size, touching) << "seed " << seed << ", pair " << k;
  }
}

// The routine that a new shape gets for its support function alone agrees with the closed forms.
TEST(Collide, GenericConvexAgrees) {
  const std::uint64_t seed = 55;
  Random random(seed);
  for (int k = 0; k < 5000; ++k) {
    const Sphere ball{random.uniform(0.1, 0.5)}, other{random.uniform(0.1, 0.5)};
    const Box box{Vec3(1.0, 0.8, 0.6)};
    const Pose X_WA = random.pose(0.6), X_WB = random.pose(0.6);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    ASSERT_NEAR(gapConvex(ball, X_WA, other, X_WB).distance, gap(ball, X_WA, other, X_WB).distance, 1e-14)
        << where;
    const Gap generic = gapConvex(ball, X_WA, box, X_WB), closed = gap(ball, X_WA, box, X_WB);
    ASSERT_NEAR(generic.distance, closed.distance, 1e-13) << where;
    const Manifold point = collideConvex(ball, X_WA, box, X_WB, 1.0),
                   exact = collide(ball, X_WA, box, X_WB, 1.0);
    ASSERT_EQ(point.size, exact.size) << where;
    if (point.size == 1) {
      ASSERT_LE((point.points[0].p_W - exact.points[0].p_W).norm(), 1e-9) << where;
    }
  }
}

}  // namespace
}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Manifolds and gaps of boxes against enumeration in long double, and the pairs that broke other engines.
#include "narrowphase/collide.h"

#include "core/narrowphase_oracles.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace rbs {
namespace {

using oracle::PlacedBox;
using oracle::Random;

Pose at(const Vec3& p, const Quat& q = Quat::Identity()) {
  return {p, q};
}

Quat turned(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

double toBox(const PlacedBox& box, const Vec3& p) {
  return static_cast<double>(box.distanceTo(p.cast<oracle::Real>()));
}

double deepest(const Manifold& manifold) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < manifold.size; ++k) least = std::min(least, manifold.points[k].separation);
  return least;
}

void expectSound(const Manifold& manifold, const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB,
                 double margin, const std::string& where) {
  const PlacedBox box_a(a, X_WA), box_b(b, X_WB);
  ASSERT_NEAR(manifold.n_W.norm(), 1.0, 1e-13) << where;
  ASSERT_LE(manifold.size, 8) << where;
  std::set<std::uint32_t> features;
  for (int k = 0; k < manifold.size; ++k) {
    const ManifoldPoint& point = manifold.points[k];
    ASSERT_LE(point.separation, margin) << where;
    features.insert(point.feature);
    // The point is midway: half of the gap to each surface along the normal. A corner may overhang by 1e-5,
    // and by the lean of the normal off the reference face, at most 2.6 degrees.
    const Vec3 half = 0.5 * point.separation * manifold.n_W;
    const double overhang = 2e-5 + 0.046 * std::abs(point.separation);
    ASSERT_LE(toBox(box_a, point.p_W - half), overhang) << where;
    ASSERT_LE(toBox(box_b, point.p_W + half), overhang) << where;
  }
  ASSERT_EQ(static_cast<int>(features.size()), manifold.size) << where;
}

TEST(BoxBox, GapMatchesEnumeration) {
  const std::uint64_t seed = 31;
  Random random(seed);
  int apart = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.5), X_WB = random.pose(0.5);
    const PlacedBox box_a(a, X_WA), box_b(b, X_WB);
    const double truth = static_cast<double>(oracle::boxGap(box_a, box_b));
    const Gap found = gap(a, X_WA, b, X_WB);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    if (truth > 0.0) ++apart;
    ASSERT_NEAR(found.distance, truth, truth > 0.0 ? 1e-14 + 1e-12 * truth : 1e-12) << where;
    // The normal proves the gap.
    const double along =
        static_cast<double>(oracle::separationAlong(box_a, box_b, found.n_W.cast<oracle::Real>()));
    ASSERT_NEAR(along, truth, 1e-8) << where;
  }
  EXPECT_GT(apart, 5000);
  EXPECT_LT(apart, 15000);
}

TEST(BoxBox, ManifoldsAreSound) {
  const std::uint64_t seed = 32;
  Random random(seed);
  int touching = 0, with_edges = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
    const double margin = random.below(2) == 0 ? 0.0 : 0.1;
    const double truth = static_cast<double>(oracle::boxGap({a, X_WA}, {b, X_WB}));
    const Manifold manifold = collide(a, X_WA, b, X_WB, margin);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    if (truth > margin + 1e-12) {
      ASSERT_EQ(manifold.size, 0) << where;
      continue;
    }
    if (truth > margin - 1e-12) continue;
    ++touching;
    ASSERT_GT(manifold.size, 0) << where;
    expectSound(manifold, a, X_WA, b, X_WB, margin, where);
    // No point is deeper than the least overlap of the fifteen axes, and the deepest is as deep, up to the
    // lean of the normal.
    if (truth < 0.0) {
      ASSERT_GE(deepest(manifold), truth - 1e-6) << where;  // of a corner that overhangs by 1e-5
      ASSERT_LE(deepest(manifold), truth + 0.046) << where;
    }
    for (int p = 0; p < manifold.size; ++p) with_edges += manifold.points[p].feature >> 31;
  }
  EXPECT_GT(touching, 4000);
  EXPECT_GT(with_edges, 300);
}

TEST(BoxBox, RestsOnFourPoints) {
  const Box cube{Vec3::Ones()};
  for (const double gap : {-0.3, -1e-3, -1e-12, 0.0, 1e-12, 1e-3, 0.009}) {
    for (const Vec3& tilt : {Vec3(0, 0, 0), Vec3(1e-8, 0, 0), Vec3(1e-8, -1e-8, 1e-8), Vec3(0, 0, 1e-6)}) {
      const Quat q = tilt.isZero() ? Quat(Quat::Identity()) : turned(tilt.norm(), tilt);
      const Manifold manifold = collide(cube, Pose(), cube, at({0, 0, 1 + gap}, q), 0.01);
      ASSERT_EQ(manifold.size, 4) << gap << ", " << tilt.transpose();
      EXPECT_NEAR(manifold.n_W.z(), 1.0, 1e-7);
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(manifold.points[k].separation, gap, 2e-8);
        EXPECT_NEAR(manifold.points[k].p_W.cwiseAbs().x(), 0.5, 1e-5);
        EXPECT_NEAR(manifold.points[k].p_W.cwiseAbs().y(), 0.5, 1e-5);
        EXPECT_NEAR(manifold.points[k].p_W.z(), 0.5 + 0.5 * gap, 2e-8);
      }
    }
  }
}

TEST(BoxBox, ClipsToAnOctagon) {
  const Box cube{Vec3::Ones()};
  const Manifold manifold =
      collide(cube, Pose(), cube, at({0, 0, 0.99}, turned(EIGEN_PI / 4, Vec3::UnitZ())), 0.0);
  ASSERT_EQ(manifold.size, 8);
  for (int k = 0; k < 8; ++k) {  // where the sides cross: (1/2, sqrt(1/2) - 1/2)
    const Vec3 p = manifold.points[k].p_W.cwiseAbs();
    EXPECT_NEAR(std::max(p.x(), p.y()), 0.5, 1e-5);
    EXPECT_NEAR(std::min(p.x(), p.y()), std::sqrt(0.5) - 0.5, 2e-5);
    EXPECT_NEAR(manifold.points[k].separation, -0.01, 1e-15);
  }
}

// Crossed edges: two beams turned by 45 degrees about their lengths, one across the other.
TEST(BoxBox, CrossesEdgesInOnePoint) {
  const Box beam{Vec3(4, 1, 1)};
  const double reach = std::sqrt(0.5);
  const Quat lower = turned(EIGEN_PI / 4, Vec3::UnitX());
  const Quat upper = turned(EIGEN_PI / 2, Vec3::UnitZ()) * lower;
  for (const double gap : {-0.01, 0.01}) {
    const Manifold manifold =
        collide(beam, at({0, 0, 0}, lower), beam, at({0.3, 0.2, 2 * reach + gap}, upper), 0.02);
    ASSERT_EQ(manifold.size, 1);
    EXPECT_NEAR(manifold.points[0].separation, gap, 1e-14);
    EXPECT_TRUE(manifold.points[0].p_W.isApprox(Vec3(0.3, 0.0, reach + 0.5 * gap), 1e-13));
    EXPECT_NEAR(manifold.n_W.z(), 1.0, 1e-14);
  }
}

// Upright edge against upright edge. What rounding leaves of an angle between them is none: they meet in a segment.
TEST(BoxBox, MeetsAlongEdgesThatAreParallelToRounding) {
  const Box cube{Vec3::Ones()};
  Random random(35);
  const Vec3 n = Vec3(1, 1, 0).normalized();
  for (int k = 0; k < 3000; ++k) {
    const double gap = random.uniform(1e-4, 1e-2), shift = random.uniform(-0.5, 0.5);
    const double tilt = k % 10 == 0 ? 0.0 : std::pow(10.0, random.uniform(-17.0, -8.0));
    const Pose lower = at({0, 0, 0}, turned(tilt, random.direction()));
    const Pose upper = at(Vec3(1, 1, shift) + gap * n, turned(tilt, random.direction()));
    const Manifold manifold = collide(cube, lower, cube, upper, 0.02);
    const std::string where = "pair " + std::to_string(k) + ", tilt " + std::to_string(tilt);
    ASSERT_EQ(manifold.size, 2) << where;
    EXPECT_NEAR(std::abs(manifold.points[0].p_W.z() - manifold.points[1].p_W.z()), 1.0 - std::abs(shift),
                1e-6)
        << where;
    for (const int p : {0, 1}) {
      EXPECT_NEAR(manifold.points[p].separation, gap, 1e-7) << where;
      EXPECT_TRUE(manifold.points[p].p_W.head<2>().isApprox(
          Eigen::Vector2d(0.5, 0.5) + 0.5 * gap * n.head<2>(), 1e-6))
          << where;
    }
  }
}

// Edges that cross at an angle of any size, and where.
TEST(BoxBox, CrossesEdgesWhereTheirLinesAreNearest) {
  const Box cube{Vec3::Ones()};
  Random random(36);
  const Vec3 n = Vec3(1, 1, 0).normalized();
  for (int k = 0; k < 3000; ++k) {
    const double angle = std::pow(10.0, random.uniform(-3.0, -0.2)), height = random.uniform(-0.4, 0.4);
    const Vec3 middle = Vec3(0.5, 0.5, height) + 0.01 * n;  // of the upper edge, over the other one
    const double along = random.uniform(-0.4, 0.4);
    const Quat q = turned(angle, n);
    const Pose upper = at(middle - q * Vec3(-0.5, -0.5, along), q);
    const Manifold manifold = collide(cube, Pose(), cube, upper, 0.0101);
    ASSERT_GE(manifold.size, 1) << angle;
    EXPECT_NEAR(deepest(manifold), 0.01, 1e-13) << angle;
    EXPECT_NEAR((manifold.points[0].p_W - (middle - 0.005 * n)).norm(), 0.0, 1e-12 / angle) << angle;
  }
}

// Corner over corner along the diagonal: no face and no pair of edges spans the gap.
TEST(BoxBox, MeetsCornerToCorner) {
  const Box cube{Vec3::Ones()};
  const Vec3 diagonal = Vec3::Ones().normalized();
  const Manifold manifold = collide(cube, Pose(), cube, at(Vec3::Ones() + 0.01 * diagonal), 0.02);
  ASSERT_EQ(manifold.size, 1);
  EXPECT_NEAR(manifold.points[0].separation, 0.01, 1e-14);
  EXPECT_TRUE(manifold.n_W.isApprox(diagonal, 1e-10));
  EXPECT_EQ(collide(cube, Pose(), cube, at(Vec3::Ones() + 0.03 * diagonal), 0.02).size, 0);
}

// A corner of the one, a corner of the other, or an edge of each: whichever of the two is first, and has the reference face.
TEST(BoxBox, PointsAreNamedByWhatTheyAreMadeOf) {
  const auto swapped = [](std::uint32_t name) -> std::uint32_t {
    if (name < 64) return name < 32 ? name + 32 : name - 32;
    const std::uint32_t edges = name - 64;
    return 64 + 27 * (edges % 27) + edges / 27;
  };
  std::array<int, 3> seen{};  // corners of the first, of the second, and crossings
  for (unsigned seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const Box a{random.inCube(0.5) + Vec3::Constant(1.0)}, b{random.inCube(0.5) + Vec3::Constant(1.0)};
    const Vec3 lean = random.inCube(1e-3);
    const Quat q(Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Vec3::UnitZ()) *
                 Eigen::AngleAxisd(lean.norm(), lean.normalized()));
    const Vec3 aside = random.inCube(0.6);
    const Pose X_WA, X_WB{Vec3(aside.x(), aside.y(), 0.5 * (a.size.z() + b.size.z()) + 1e-3), q};
    const Manifold one = collide(a, X_WA, b, X_WB, 0.02), other = collide(b, X_WB, a, X_WA, 0.02);
    std::set<std::uint32_t> names, swapped_back;
    for (int k = 0; k < one.size; ++k) {
      names.insert(one.points[k].feature);
      ++seen[one.points[k].feature < 32 ? 0 : one.points[k].feature < 64 ? 1 : 2];
    }
    for (int k = 0; k < other.size; ++k) swapped_back.insert(swapped(other.points[k].feature));
    ASSERT_EQ(names, swapped_back) << "seed " << seed;
  }
  for (const int kind : seen) EXPECT_GT(kind, 100);
}

// The features stay while a cube on another wavers by less than it takes to lift a corner.
TEST(BoxBox, FeaturesAreStable) {
  const std::uint64_t seed = 33;
  Random random(seed);
  const Box cube{Vec3::Ones()};
  const auto features = [&](const Pose& X_WB) {
    std::set<std::uint32_t> set;
    const Manifold manifold = collide(cube, Pose(), cube, X_WB, 0.01);
    for (int k = 0; k < manifold.size; ++k) set.insert(manifold.points[k].feature);
    return set;
  };
  const std::set<std::uint32_t> first = features(at({0.5, 0.0, 0.999}));
  EXPECT_EQ(first.size(), 4u);
  for (int k = 0; k < 1000; ++k) {
    const Quat q = turned(random.uniform(0, 1e-6), random.direction());
    EXPECT_EQ(features(at(Vec3(0.5, 0.0, 0.999) + random.inCube(1e-6), q)), first)
        << "seed " << seed << ", " << k;
  }
}

// Hard case A49: depth of a small box in a huge one.
TEST(BoxBox, SmallOnHuge) {
  for (const double ratio : {1e3, 1e6}) {
    const Box huge{Vec3(ratio, ratio, 1.0)}, small{Vec3::Ones()};
    const Pose X_WB = at({0.3 * ratio, 0.2 * ratio, 1.0 - 0.000754}, turned(0.4, Vec3::UnitZ()));
    const Manifold manifold = collide(huge, Pose(), small, X_WB, 0.0);
    ASSERT_EQ(manifold.size, 4);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(manifold.points[k].separation, -0.000754, 0.000754e-9);
  }
}

}  // namespace
}  // namespace rbs

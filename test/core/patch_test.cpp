// SPDX-License-Identifier: BSD-3-Clause
// Manifolds of convex pairs: the patch in which two facets lie on each other.
#include "core/narrowphase_oracles.h"
#include "narrowphase/collide.h"
#include "narrowphase/convex.h"
#include "rigid_body_sim/polyhedron.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rbs {
namespace {

using oracle::Random;

Pose at(const Vec3& p_W, const Quat& q = Quat::Identity()) {
  return {p_W, q};
}

Quat turned(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

const Quat kLying = turned(0.5 * 3.14159265358979323846, Vec3::UnitY());

double deepest(const Manifold& manifold) {
  double depth = std::numeric_limits<double>::infinity();
  for (int k = 0; k < manifold.size; ++k) depth = std::min(depth, manifold.points[k].separation);
  return depth;
}

// Area of the polygon that the points span, in order around their centre.
double area(const Manifold& manifold) {
  double twice = 0.0;
  for (int i = 0; i < manifold.size; ++i) {
    const Vec3 a = manifold.points[i].p_W - manifold.points[0].p_W;
    const Vec3 b = manifold.points[(i + 1) % manifold.size].p_W - manifold.points[0].p_W;
    twice += manifold.n_W.dot(a.cross(b));
  }
  return 0.5 * std::abs(twice);
}

std::set<std::uint32_t> features(const Manifold& manifold) {
  std::set<std::uint32_t> set;
  for (int k = 0; k < manifold.size; ++k) set.insert(manifold.points[k].feature);
  return set;
}

// The two surfaces at a point of the manifold lie half its separation to either side, on or within the
// shapes.
void expectSound(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 const std::string& where) {
  const Manifold manifold = collide(a, X_WA, b, X_WB, margin);
  const Gap span = gap(a, X_WA, b, X_WB);
  const double size = boundingRadius(a) + boundingRadius(b);
  if (span.distance > margin) {
    ASSERT_EQ(manifold.size, 0) << where;
    return;
  }
  ASSERT_GT(manifold.size, 0) << where;
  // No corner of the patch is deeper than the deepest point, and one is as deep.
  ASSERT_NEAR(deepest(manifold), span.distance, 2e-5 * size) << where;
  const double outside = 1e-4 * size;  // a corner may overhang by 1e-5 of the size, and its facet slants
  const Sphere tip{1e-9 * size};
  for (int k = 0; k < manifold.size; ++k) {
    const ManifoldPoint& point = manifold.points[k];
    ASSERT_LE(point.separation, margin) << where;
    const Vec3 half = 0.5 * point.separation * manifold.n_W;
    ASSERT_LE(gap(tip, at(point.p_W - half), a, X_WA).distance, outside) << where << ", point " << k;
    ASSERT_LE(gap(tip, at(point.p_W + half), b, X_WB).distance, outside) << where << ", point " << k;
  }
}

TEST(Patch, HoldsThePointsWhereTheShapesMeet) {
  const std::uint64_t seed = 71;
  Random random(seed);
  const std::vector<Shape> shapes{Box{Vec3(0.6, 0.9, 0.4)}, Capsule{0.2, 0.4}, Cylinder{0.3, 0.4},
                                  Cone{0.4, 0.7}};
  for (int k = 0; k < 20000; ++k) {
    const Shape &a = shapes[random.below(4)], &b = shapes[random.below(4)];
    const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
    if (a.index() == 1 && b.index() == 1) continue;  // boxes have a test of their own
    expectSound(a, X_WA, b, X_WB, random.below(2) == 0 ? 0.0 : 0.02,
                shapeName(a) + " and " + shapeName(b) + ", seed " + std::to_string(seed) + ", pair " +
                    std::to_string(k));
    if (HasFatalFailure()) return;
  }
}

// The generic routine finds the corners of boxes on each other that the routine for boxes finds.
TEST(Patch, AgreesWithBoxes) {
  const std::uint64_t seed = 72;
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    const Box a = random.box(), b = random.box();
    const Quat q = turned(random.uniform(0.0, 3.0), Vec3::UnitZ());
    const double overlap = random.uniform(0.0, 1e-3);
    const Pose X_WB = at(
        {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.5 * (a.size.z() + b.size.z()) - overlap}, q);
    const Manifold special = collide(a, Pose(), b, X_WB, 0.0),
                   generic = collideConvex(a, Pose(), b, X_WB, 0.0);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    ASSERT_EQ(generic.size == 0, special.size == 0) << where;
    if (special.size == 0 || std::abs(special.n_W.z()) < 0.9) continue;
    ASSERT_TRUE(generic.n_W.isApprox(special.n_W, 1e-9)) << where;
    ASSERT_NEAR(area(generic), area(special), 1e-4) << where;
    ASSERT_NEAR(deepest(generic), -overlap, 1e-12) << where;
  }
}

TEST(Patch, CylindersStandLieAndLean) {
  const Box floor{Vec3(4, 4, 1)};
  const Cylinder can{0.25, 0.5};
  const Shape wall = Plane{};
  for (const Shape& ground : {Shape(floor), wall}) {
    const Pose X_ground = std::holds_alternative<Plane>(ground) ? Pose() : at({0, 0, -0.5});
    EXPECT_EQ(collide(can, at({0, 0, 0.4999}), ground, X_ground, 0.001).size, 8);
    const Manifold line = collide(can, at({0, 0, 0.2499}, kLying), ground, X_ground, 0.001);
    ASSERT_EQ(line.size, 2);
    EXPECT_NEAR((line.points[0].p_W - line.points[1].p_W).norm(), 1.0, 1e-9);
    // Leaning by an angle that none of the eight points of the rim looks along: it stands on the lowest
    // point.
    const double lean = 0.01;
    const Quat q = turned(lean, Vec3(std::cos(0.4), std::sin(0.4), 0.0));
    const double lowest = 0.5 * std::cos(lean) + 0.25 * std::sin(lean);
    const Manifold rim = collide(can, at({0, 0, lowest - 1e-4}, q), ground, X_ground, 0.0);
    ASSERT_GT(rim.size, 0);
    EXPECT_NEAR(deepest(rim), -1e-4, 1e-9);
  }
}

TEST(Patch, ConesStandAndLie) {
  const Cone cone{0.3, 0.8};
  EXPECT_EQ(collide(cone, at({0, 0, 0.2 - 1e-4}), Box{Vec3(4, 4, 1)}, at({0, 0, -0.5}), 0.001).size, 8);
  // On its side, a line of the cone is level: its axis is raised by the half angle at the apex.
  const double half_angle = std::atan2(0.3, 0.8);
  const Quat q = turned(0.5 * 3.14159265358979323846 + half_angle, Vec3::UnitY());
  const double height =
      0.6 * std::sin(half_angle);  // of the centre of mass, 3/4 of the height below the apex
  const Manifold line =
      collide(cone, at({0, 0, height - 1e-5}, q), Box{Vec3(4, 4, 1)}, at({0, 0, -0.5}), 0.001);
  ASSERT_EQ(line.size, 2);
  EXPECT_NEAR((line.points[0].p_W - line.points[1].p_W).norm(), std::hypot(0.3, 0.8), 1e-4);
}

TEST(Patch, CapsulesMeetInALineOrAPoint) {
  const Capsule rod{0.1, 0.5};
  const Pose across = at({0, 0, 0.199}, turned(1.0, Vec3::UnitX()));
  EXPECT_EQ(collide(rod, at({0, 0, 0}, kLying), rod, at({0.2, 0, 0.199}, kLying), 0.0).size, 2);
  EXPECT_EQ(
      collide(rod, at({0, 0, 0}, kLying), rod, at({0, 0, 0.199}, turned(1.0, Vec3::UnitZ()) * kLying), 0.0)
          .size,
      1);
  EXPECT_EQ(collide(rod, at({0, 0, 0}, kLying), rod, across, 0.0).size, 1);
  // Parallel and side by side for 0.8 of their length of 1.
  const Manifold beside = collide(rod, at({0, 0, 0}, kLying), rod, at({0.2, 0, 0.199}, kLying), 0.0);
  EXPECT_NEAR((beside.points[0].p_W - beside.points[1].p_W).norm(), 0.8, 1e-9);
}

// Round sides of radii r and s whose axes cross a little: d beside each other, they are apart by
//   D - max over x of sqrt(r² - x²) + sqrt(s² - (d - x)²)
// along the normal, with D the distance of the axes, here by trying places x.
double crossingGap(double D, double r, double s, double d) {
  double most = 0.0;
  for (int k = 0; k <= 20000; ++k) {
    const double x = d * k / 20000.0;
    most = std::max(most, std::sqrt(r * r - x * x) + std::sqrt(s * s - (d - x) * (d - x)));
  }
  return D - most;
}

TEST(Patch, RodsThatCrossALittleMeetInALine) {
  const double half = 0.5;
  for (const auto& [r, s] : {std::pair(0.2, 0.2), std::pair(0.05, 0.3)})
    for (const double angle : {0.0, 1e-9, 1e-6, 1e-4, 1e-3, 0.9e-2 * (r + s) / half})
      for (const double depth : {0.0, 1e-6, 1e-3 * s})
        for (const auto& [lower, upper] : {std::pair<Shape, Shape>(Cylinder{r, half}, Cylinder{s, half}),
                                           std::pair<Shape, Shape>(Capsule{r, half}, Cylinder{s, half}),
                                           std::pair<Shape, Shape>(Cylinder{r, half}, Capsule{s, half}),
                                           std::pair<Shape, Shape>(Capsule{r, half}, Capsule{s, half})}) {
          const std::string where = shapeName(lower) + " and " + shapeName(upper) + " crossing by " +
                                    std::to_string(angle) + ", " + std::to_string(depth) + " deep";
          const double D = r + s - depth;
          const Manifold line = collide(lower, at({0, 0, 0}, kLying), upper,
                                        at({0, 0, D}, turned(angle, Vec3::UnitZ()) * kLying), 1e-3);
          ASSERT_GE(line.size, 2) << where;
          double from = half, to = -half;
          for (int k = 0; k < line.size; ++k) {
            const double x = line.points[k].p_W.x();
            EXPECT_NEAR(line.points[k].separation, crossingGap(D, r, s, std::abs(x) * std::sin(angle)),
                        1e-8 * (r + s))
                << where;
            from = std::min(from, x), to = std::max(to, x);
          }
          EXPECT_NEAR(to - from, 2.0 * half, 1e-3 * half) << where;
        }
}

// The line of a cone is no line where the cone is tilted along it.
TEST(Patch, WhatIsTiltedMeetsInNoLine) {
  const Cylinder rod{0.2, 0.5};
  for (const double tilt : {0.05, 0.2}) {
    const double height = 0.2 + 0.5 * std::sin(tilt) + 0.2 * std::cos(tilt) - 1e-6;
    const Manifold manifold = collide(rod, at({0, 0, 0}, kLying), rod,
                                      at({-0.2, 0, height}, turned(tilt, Vec3::UnitY()) * kLying), 1e-3);
    EXPECT_EQ(manifold.size, 1) << tilt;
  }
}

// While shapes that lie on each other waver, their corners keep their names.
TEST(Patch, FeaturesAreStable) {
  const std::uint64_t seed = 73;
  Random random(seed);
  const Box floor{Vec3(4, 4, 1)};
  const std::vector<std::pair<Shape, Pose>> resting{{Cylinder{0.25, 0.5}, at({0.1, 0, 0.999})},
                                                    {Cylinder{0.25, 0.5}, at({0.1, 0, 0.749}, kLying)},
                                                    {Capsule{0.25, 0.5}, at({0.1, 0, 0.749}, kLying)},
                                                    {Cone{0.3, 0.8}, at({0.1, 0, 0.699})}};
  for (const auto& [shape, pose] : resting) {
    const std::set<std::uint32_t> first = features(collide(floor, Pose(), shape, pose, 0.01));
    EXPECT_GE(first.size(), 2u);
    for (int k = 0; k < 1000; ++k) {
      const Pose wavering = at(pose.p_WB + random.inCube(1e-6),
                               turned(random.uniform(0, 1e-6), random.direction()) * pose.q_WB);
      ASSERT_EQ(features(collide(floor, Pose(), shape, wavering, 0.01)), first)
          << shapeName(shape) << ", seed " << seed << ", " << k;
    }
  }
}

TEST(Patch, DoesNotDependOnTheUnit) {
  const std::uint64_t seed = 74;
  Random random(seed);
  const std::vector<Shape> shapes{Box{Vec3(0.6, 0.9, 0.4)}, Capsule{0.2, 0.4}, Cylinder{0.3, 0.4},
                                  Cone{0.4, 0.7}};
  for (const double unit : {0x1p-20, 0x1p20})  // powers of two scale without rounding
    for (int k = 0; k < 2000; ++k) {
      const Shape &a = shapes[random.below(4)], &b = shapes[random.below(4)];
      const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
      const Manifold here = collide(a, X_WA, b, X_WB, 0.02);
      const Manifold there = collide(scaled(a, unit), at(unit * X_WA.p_WB, X_WA.q_WB), scaled(b, unit),
                                     at(unit * X_WB.p_WB, X_WB.q_WB), 0.02 * unit);
      ASSERT_EQ(features(here), features(there)) << "seed " << seed << ", pair " << k;
      for (int p = 0; p < here.size; ++p)
        ASSERT_NEAR(there.points[p].separation / unit, here.points[p].separation, 1e-12);
    }
}

// A box as it is, or as a hull, with its pose.
std::pair<Shape, Pose> boxAs(bool hull, const Vec3& size, const Pose& X_WB) {
  if (!hull) return {Box{size}, X_WB};
  std::vector<Vec3> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) corners.push_back(Vec3(x, y, z).cwiseProduct(size));
  const PlacedHull placed = makeHull(corners, "box");
  return {placed.hull, placed.poseOfB(X_WB)};
}

// A small box leans over a floor of any size: the points are below its corners, whichever of the two comes first.
TEST(Patch, CornersAreWhereTheyAre) {
  const std::uint64_t seed = 75;
  Random random(seed);
  int points = 0;
  for (const double extent : {4.0, 400.0})
    for (const bool hull : {false, true})
      for (const bool floor_is_hull : {false, true})
        for (int k = 0; k < 100; ++k) {
          const Vec3 size = Vec3::Constant(0.3) + random.inCube(0.1);
          const Quat q = turned(random.uniform(0, 3), Vec3::UnitZ()) *
                         turned(random.uniform(0, 0.7), random.direction());
          const Vec3 reach = 0.5 * q.toRotationMatrix().cwiseAbs() * size;
          const Pose X_WB =
              at({random.uniform(-1, 1), random.uniform(-1, 1), reach.z() + random.uniform(-1e-4, 1e-4)}, q);
          const auto [floor, X_WF] = boxAs(floor_is_hull, {extent, extent, 0.5}, at({0, 0, -0.25}));
          const auto [box, X_WH] = boxAs(hull, size, X_WB);
          for (const bool floor_first : {false, true}) {
            const Manifold manifold =
                floor_first ? collide(floor, X_WF, box, X_WH, 0.1) : collide(box, X_WH, floor, X_WF, 0.1);
            ASSERT_GT(manifold.size, 0);
            for (int p = 0; p < manifold.size; ++p) {
              const ManifoldPoint& point = manifold.points[p];
              const Vec3 corner_W = point.p_W + 0.5 * point.separation * Vec3::UnitZ();
              const Vec3 corner = (X_WB.q_WB.conjugate() * (corner_W - X_WB.p_WB)).cwiseAbs() - 0.5 * size;
              // Of two boxes, what is open lies along the normal of the reference face, at most 2.6 degrees off.
              const double lean = hull || floor_is_hull ? 0.0 : 0.046 * std::abs(point.separation);
              EXPECT_LE(corner.cwiseAbs().maxCoeff(), 1e-12 * extent + lean)
                  << extent << hull << floor_is_hull << floor_first;
              ++points;
            }
          }
        }
  EXPECT_GT(points, 3000);
}

// How far a corner may hang over the edge of a face goes by the smaller of the two: a floor of a kilometre has no shelf.
TEST(Patch, NothingStandsBesideAHugeFace) {
  for (const double extent : {1.0, 1e3})
    for (const bool hull : {false, true})
      for (const bool floor_is_hull : {false, true})
        for (const bool floor_first : {false, true}) {
          const auto [floor, X_WF] = boxAs(floor_is_hull, {extent, extent, 0.5}, at({0, 0, -0.25}));
          const auto [box, X_WB] = boxAs(hull, Vec3::Constant(0.1), at({0.5 * extent + 0.048, 0, 0.05}));
          const Manifold manifold =
              floor_first ? collide(floor, X_WF, box, X_WB, 1e-4) : collide(box, X_WB, floor, X_WF, 1e-4);
          ASSERT_GT(manifold.size, 0);
          for (int k = 0; k < manifold.size; ++k)
            EXPECT_LE(manifold.points[k].p_W.x(), 0.5 * extent + 2e-6)
                << extent << hull << floor_is_hull << floor_first;
        }
}

TEST(Patch, ReducesToFourPointsOfTheLargestArea) {
  Manifold octagon = collide(Box{Vec3::Ones()}, Pose(), Box{Vec3::Ones()},
                             at({0, 0, 0.999}, turned(0.7, Vec3::UnitZ())), 0.0);
  ASSERT_EQ(octagon.size, 8);
  octagon.points[5].separation = -0.01;
  const std::uint32_t deep = octagon.points[5].feature;
  const double whole = area(octagon);
  reduceToFour(octagon);
  ASSERT_EQ(octagon.size, 4);
  EXPECT_EQ(features(octagon).count(deep), 1u);
  EXPECT_GT(area(octagon), 0.6 * whole);
}

}  // namespace
}  // namespace rbs

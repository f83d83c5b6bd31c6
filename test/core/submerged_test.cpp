// SPDX-License-Identifier: BSD-3-Clause
// The part of a shape below a plane, against closed forms and brute force.
#include "shapes/submerged.h"
#include "base/algebra.h"
#include "base/random.h"

#include <gtest/gtest.h>

using namespace rbs;

namespace {

Vec3 randomDirection(SplitMix64& random) {
  while (true) {
    const Vec3 d(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
    if (d.norm() > 0.1 && d.norm() <= 1.0) return d.normalized();
  }
}

std::vector<Shape> shapes() {
  const std::vector<Vec3> points{
      {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.3, 0.0}, {0.0, 0.0, 0.7}, {0.8, 0.9, 0.6}};
  return {Sphere{0.4},        Box{{0.3, 0.7, 1.1}}, Capsule{0.2, 0.5},
          Cylinder{0.3, 0.6}, Cone{0.5, 1.2},       makeHull(points, "points").hull};
}

bool contains(const Shape& shape, const Vec3& x) {
  const double r = std::hypot(x.x(), x.y());
  if (const auto* ball = std::get_if<Sphere>(&shape)) return x.norm() <= ball->radius;
  if (const auto* box = std::get_if<Box>(&shape)) return (x.cwiseAbs() - 0.5 * box->size).maxCoeff() <= 0.0;
  if (const auto* c = std::get_if<Capsule>(&shape))
    return (x - std::clamp(x.z(), -c->half_length, c->half_length) * Vec3::UnitZ()).norm() <= c->radius;
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return r <= c->radius && std::abs(x.z()) <= c->half_length;
  if (const auto* c = std::get_if<Cone>(&shape)) {
    const double share = 0.75 - x.z() / c->height;
    return share >= 0.0 && share <= 1.0 && r <= c->radius * share;
  }
  for (const Polyhedron::Face& face : std::get<ConvexHull>(shape).polyhedron->faces)
    if (face.normal.dot(x) > face.offset) return false;
  return true;
}

TEST(Submerged, AllOfABodyIsItsVolumeAboutItsCentre) {
  SplitMix64 random(1);
  for (const Shape& shape : shapes()) {
    for (int k = 0; k < 100; ++k) {
      const double depth = std::pow(10.0, 8.0 * random.uniform()) * boundingRadius(shape);
      const SubmergedPart all = submergedPart(shape, randomDirection(random), depth);
      EXPECT_NEAR(all.volume, volume(shape), 1e-12 * volume(shape)) << shapeName(shape);
      EXPECT_LE(all.centre_B.norm(), 1e-12 * boundingRadius(shape)) << shapeName(shape);
    }
    EXPECT_EQ(submergedPart(shape, Vec3::UnitZ(), -2.0 * boundingRadius(shape)).volume, 0.0);
  }
}

// What is below and what is above make the whole, and so do their moments.
TEST(Submerged, BothSidesOfThePlaneMakeTheWhole) {
  SplitMix64 random(2);
  for (const Shape& shape : shapes()) {
    for (int k = 0; k < 2000; ++k) {
      const Vec3 up = k % 10 == 0 ? Vec3(Vec3::Unit(k % 3)) : randomDirection(random);
      const double level = (2.0 * random.uniform() - 1.0) * boundingRadius(shape);
      const SubmergedPart below = submergedPart(shape, up, level), above = submergedPart(shape, -up, -level);
      EXPECT_NEAR(below.volume + above.volume, volume(shape), 1e-12 * volume(shape)) << shapeName(shape);
      const Vec3 moment = below.volume * below.centre_B + above.volume * above.centre_B;
      EXPECT_LE(moment.norm(), 1e-12 * volume(shape) * boundingRadius(shape)) << shapeName(shape);
    }
  }
}

// The volume grows with the level by the area of the cut; the moment along `up` by the level times that area.
// So a fine sum of the slices must give the moment: an oracle that knows only the volumes.
TEST(Submerged, TheMomentAlongUpFollowsFromTheVolumes) {
  SplitMix64 random(3);
  for (const Shape& shape : shapes()) {
    for (int k = 0; k < 5; ++k) {
      const Vec3 up = randomDirection(random);
      const double from = -boundingRadius(shape), to = 0.3 * boundingRadius(shape);
      const int slices = 4000;
      double moment = 0.0, before = 0.0;
      for (int s = 1; s <= slices; ++s) {
        const double level = from + (to - from) * s / slices;
        const double now = submergedPart(shape, up, level).volume;
        moment += (level - 0.5 * (to - from) / slices) * (now - before);
        before = now;
      }
      const SubmergedPart part = submergedPart(shape, up, to);
      EXPECT_NEAR(part.volume * part.centre_B.dot(up), moment, 1e-6 * volume(shape) * boundingRadius(shape));
    }
  }
}

// Points of a grid, counted.
TEST(Submerged, AgreesWithCountedPoints) {
  SplitMix64 random(4);
  for (const Shape& shape : shapes()) {
    const Vec3 up = randomDirection(random);
    const double level = 0.2 * boundingRadius(shape);
    const Aabb bounds = localBounds(shape);
    const Vec3 cell = (bounds.hi - bounds.lo) / 120.0;
    const int n = 120;
    double inside = 0.0;
    Vec3 moment = Vec3::Zero();
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        for (int c = 0; c < n; ++c) {
          const Vec3 x = bounds.lo + cell.cwiseProduct(Vec3(a + 0.5, b + 0.5, c + 0.5));
          if (up.dot(x) > level || !contains(shape, x)) continue;
          inside += 1.0;
          moment += x;
        }
    const SubmergedPart part = submergedPart(shape, up, level);
    EXPECT_NEAR(part.volume, inside * cell.prod(), 0.01 * volume(shape)) << shapeName(shape);
    EXPECT_LE((part.centre_B - moment / inside).norm(), 0.01 * boundingRadius(shape)) << shapeName(shape);
  }
}

TEST(Submerged, HalfABallHasItsCentreAtThreeEighthsOfItsRadius) {
  const SubmergedPart half = submergedPart(Sphere{2.0}, Vec3::UnitX(), 0.0);
  EXPECT_NEAR(half.volume, 2.0 / 3.0 * kPi * 8.0, 1e-13);
  EXPECT_NEAR(half.centre_B.x(), -0.75, 1e-14);
}

}  // namespace

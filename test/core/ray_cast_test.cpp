// SPDX-License-Identifier: BSD-3-Clause
// Rays against shapes: where a hit is on the surface, with nothing of the shape before it, and a miss is a
// miss, it is judged in long double by what a point is outside of.
#include "narrowphase/ray_cast.h"

#include "core/narrowphase_oracles.h"

#include <gtest/gtest.h>

#include <functional>
#include <iostream>

namespace rbs {
namespace {

using oracle::Random;
using oracle::Real;
using oracle::Vec;

// A function of the points of a shape's frame that is convex, negative inside, zero on the surface and
// positive outside; and how far the shape reaches along a direction.
Real outside(const Sphere& sphere, const Vec& p) {
  return p.norm() - sphere.radius;
}
Real reach(const Sphere& sphere, const Vec& n) {
  return sphere.radius * n.norm();
}

Real outside(const Box& box, const Vec& p) {
  return (p.cwiseAbs() - 0.5L * box.size.cast<Real>()).maxCoeff();
}
Real reach(const Box& box, const Vec& n) {
  return n.cwiseAbs().dot(0.5L * box.size.cast<Real>());
}

Real outside(const Capsule& capsule, const Vec& p) {
  const Real z = std::clamp(p.z(), -Real(capsule.half_length), Real(capsule.half_length));
  return (p - Vec(0, 0, z)).norm() - capsule.radius;
}
Real reach(const Capsule& capsule, const Vec& n) {
  return capsule.radius * n.norm() + capsule.half_length * std::abs(n.z());
}

Real outside(const Cylinder& cylinder, const Vec& p) {
  return std::max(std::hypot(p.x(), p.y()) - cylinder.radius, std::abs(p.z()) - cylinder.half_length);
}
Real reach(const Cylinder& cylinder, const Vec& n) {
  return cylinder.radius * std::hypot(n.x(), n.y()) + cylinder.half_length * std::abs(n.z());
}

Real outside(const Cone& cone, const Vec& p) {
  const Real r = cone.radius, h = cone.height;
  const Real side = (h * std::hypot(p.x(), p.y()) - r * (0.75L * h - p.z())) / std::hypot(r, h);
  return std::max(side, -0.25L * h - p.z());
}
Real reach(const Cone& cone, const Vec& n) {
  return std::max(0.75L * cone.height * n.z(),
                  cone.radius * std::hypot(n.x(), n.y()) - 0.25L * cone.height * n.z());
}

Real outside(const ConvexHull& hull, const Vec& p) {
  Real most = -std::numeric_limits<Real>::infinity();
  for (const Polyhedron::Face& face : hull.polyhedron->faces)
    most = std::max(most, face.normal.cast<Real>().dot(p) - face.offset);
  return most;
}
Real reach(const ConvexHull& hull, const Vec& n) {
  Real most = -std::numeric_limits<Real>::infinity();
  for (const Vec3& vertex : hull.polyhedron->vertices) most = std::max(most, n.dot(vertex.cast<Real>()));
  return most;
}

// The least of a convex function, and where.
struct Least {
  Real t, value;
};
Least leastOf(const std::function<Real(Real)>& f, Real low, Real high) {
  for (int k = 0; k < 110; ++k) {
    const Real a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (f(a) <= f(b))
      high = b;
    else
      low = a;
  }
  return {low, f(low)};
}

struct Ray {
  Vec3 origin, d;
};

// From anywhere around the shape, near or far, and now and then inside; towards a place near it. One in four
// goes along an axis or a plane of the frame, but for components as small as rounding leaves them, or
// smaller.
Ray randomRay(Random& random, double size) {
  const double distance = std::pow(10.0, random.uniform(-1.0, 2.0)) * size;
  const Vec3 target = size * random.inCube(1.2);
  if (random.below(4) > 0) {
    const Vec3 origin = distance * random.direction();
    return {origin, (target - origin).normalized()};
  }
  Vec3 d = random.direction();
  for (int tiny = 1 + random.below(2), k = random.below(3); tiny > 0; --tiny, k = (k + 1) % 3)
    d[k] = random.below(8) > 0 ? std::copysign(std::pow(10.0, random.uniform(-323.0, -5.0)), d[k]) : 0.0;
  d.normalize();
  return {target - distance * d, d};
}

struct Tally {
  int hits = 0, misses = 0, starts_inside = 0, grazing = 0;
  double worst = 0.0;  // error of the distance, over the size and what the coordinates allow
};

template <class ShapeT>
void checkRay(const ShapeT& shape, const Ray& ray, const std::optional<RayEntry>& entry, Tally& counts,
              const std::string& where) {
  const Vec o = ray.origin.cast<Real>(), d = ray.d.cast<Real>();
  const Real size = boundingRadius(shape);
  const Real end = o.norm() + 2 * size, rounding = 1e-15L * (o.norm() + size);
  const auto f = [&](Real t) { return outside(shape, Vec(o + t * d)); };
  const Least least = leastOf(f, 0, end);
  if (std::abs(least.value) < 1e-9L * size) {
    ++counts.grazing;
    return;
  }
  if (least.value > 0) {
    ++counts.misses;
    ASSERT_FALSE(entry) << where;
    return;
  }
  ASSERT_TRUE(entry) << where;
  if (f(0) <= 0) {
    ++counts.starts_inside;
    ASSERT_EQ(entry->distance, 0.0) << where;
    ASSERT_EQ(entry->n_B, Vec3(-ray.d)) << where;
    return;
  }
  ++counts.hits;
  // The first zero of a function that falls from 0 to its least place.
  Real before = 0, after = least.t;
  for (int k = 0; k < 80; ++k) {
    const Real middle = 0.5L * (before + after);
    (f(middle) > 0 ? before : after) = middle;
  }
  const Real h = 1e-7L * size;
  const Real steepness = std::min(Real(1), (f(before - h) - f(before)) / h);
  const Real error = std::abs(entry->distance - before) * steepness - rounding;
  counts.worst = std::max(counts.worst, static_cast<double>(error / size));
  ASSERT_LE(counts.worst, 1e-12) << where;
  // All of the shape is behind the plane of the hit.
  const Vec n = entry->n_B.cast<Real>();
  ASSERT_NEAR(entry->n_B.norm(), 1.0, 1e-14) << where;
  ASSERT_LT(entry->n_B.dot(ray.d), 0.0) << where;
  ASSERT_LE(static_cast<double>(reach(shape, n) - n.dot(o + before * d)), 1e-12 * static_cast<double>(size))
      << where;
}

template <class ShapeT>
using Cast = std::function<std::optional<RayEntry>(const ShapeT&, const Ray&)>;

template <class ShapeT>
void checkShape(std::uint64_t seed, const std::function<ShapeT(Random&)>& random_shape,
                const Cast<ShapeT>& cast) {
  Random random(seed);
  Tally counts;
  for (int k = 0; k < 100000 && !testing::Test::HasFatalFailure(); ++k) {
    const ShapeT shape = random_shape(random);
    const Ray ray = randomRay(random, boundingRadius(shape));
    checkRay(shape, ray, cast(shape, ray), counts,
             "seed " + std::to_string(seed) + ", ray " + std::to_string(k));
  }
  std::cout << "largest error " << counts.worst << " of the size\n";
  EXPECT_GT(counts.hits, 10000);
  EXPECT_GT(counts.misses, 10000);
  EXPECT_GT(counts.starts_inside, 500);
  EXPECT_LT(counts.grazing, 100);
}

template <class ShapeT>
std::optional<RayEntry> castOnShape(const ShapeT& shape, const Ray& ray) {
  return castRay(shape, ray.origin, ray.d);
}
template <class ShapeT>
std::optional<RayEntry> castOnSupport(const ShapeT& shape, const Ray& ray) {
  return castRayOnSupport(coreOf(shape), coreRadius(shape), ray.origin, ray.d);
}

double anySize(Random& random) {
  return std::pow(10.0, random.uniform(-3, 3));
}
Sphere anySphere(Random& random) {
  return {anySize(random)};
}
Box anyBox(Random& random) {
  return Box{anySize(random) * random.box().size};
}

double anyRatio(Random& random) {
  return std::pow(10.0, random.uniform(-2, 2));
}
Capsule anyCapsule(Random& random) {
  const double size = anySize(random);
  return {size, size * anyRatio(random)};
}
Cylinder anyCylinder(Random& random) {
  const double size = anySize(random);
  return {size, size * anyRatio(random)};
}
// One of a few hulls of 4 to 40 points.
ConvexHull anyHull(Random& random) {
  static const std::vector<ConvexHull> hulls = [] {
    Random shapes(73);
    std::vector<ConvexHull> made;
    for (int k = 0; k < 60; ++k) {
      std::vector<Vec3> points(static_cast<std::size_t>(4 + shapes.below(37)));
      const double size = anySize(shapes);
      for (Vec3& point : points) point = size * shapes.inCube(1.0).cwiseProduct(Vec3(1.0, 0.5, 0.2));
      made.push_back(makeHull(points, "points").hull);
    }
    return made;
  }();
  return hulls[static_cast<std::size_t>(random.below(60))];
}
Cone anyCone(Random& random) {
  const double size = anySize(random);
  return {size, size * anyRatio(random)};
}

TEST(RayCast, EntersASphereWhereItsSurfaceIs) {
  checkShape<Sphere>(61, anySphere, castOnShape<Sphere>);
}

TEST(RayCast, EntersABoxWhereItsSurfaceIs) {
  checkShape<Box>(62, anyBox, castOnShape<Box>);
}

TEST(RayCast, EntersACapsuleWhereItsSurfaceIs) {
  checkShape<Capsule>(66, anyCapsule, castOnShape<Capsule>);
}

TEST(RayCast, EntersACylinderWhereItsSurfaceIs) {
  checkShape<Cylinder>(67, anyCylinder, castOnShape<Cylinder>);
}

TEST(RayCast, EntersAConeWhereItsSurfaceIs) {
  checkShape<Cone>(68, anyCone, castOnShape<Cone>);
}

TEST(RayCast, EntersAHullWhereItsSurfaceIs) {
  checkShape<ConvexHull>(71, anyHull, castOnShape<ConvexHull>);
}

// Found by fuzzing: the distance to the plane overflowed, and the hit was at infinity.
TEST(RayCast, ThatHardlyFallsMeetsAPlaneNowhere) {
  for (const double slope : {0.0, -1e-309, -5e-324})
    EXPECT_FALSE(castRay(Plane{}, Vec3(1.0, 2.0, 4.5), Vec3(1.0, 0.0, slope)).has_value()) << slope;
  const auto far = castRay(Plane{}, Vec3(1.0, 2.0, 4.5), Vec3(1.0, 0.0, -1e-300));
  ASSERT_TRUE(far.has_value());
  EXPECT_DOUBLE_EQ(far->distance, 4.5e300);
}

TEST(RayCast, EntersAPlaneWhereItsSurfaceIs) {
  Random random(63);
  for (int k = 0; k < 100000; ++k) {
    const Ray ray{random.inCube(1.0), random.direction()};
    const auto entry = castRay(Plane{}, ray.origin, ray.d);
    const Real t = Real(ray.origin.z()) / -Real(ray.d.z());
    ASSERT_EQ(entry.has_value(), ray.origin.z() <= 0.0 || t >= 0) << "seed 63, ray " << k;
    if (!entry) continue;
    const bool above = ray.origin.z() > 0.0;
    ASSERT_NEAR(entry->distance, static_cast<double>(above ? t : 0),
                static_cast<double>(1e-15L * std::abs(t)))
        << "seed 63, ray " << k;
    ASSERT_EQ(entry->n_B, above ? Vec3(Vec3::UnitZ()) : Vec3(-ray.d)) << "seed 63, ray " << k;
  }
}

TEST(RayCast, SupportFunctionsAloneGiveTheSame) {
  checkShape<Sphere>(64, anySphere, castOnSupport<Sphere>);
  checkShape<Box>(65, anyBox, castOnSupport<Box>);
  checkShape<ConvexHull>(72, anyHull, castOnSupport<ConvexHull>);
}

}  // namespace
}  // namespace rbs

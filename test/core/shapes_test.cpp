// SPDX-License-Identifier: BSD-3-Clause
// Mass properties and bounds of the shapes against closed forms and against sums over small cells.
#include "rigid_body_sim/shape.h"

#include "rigid_body_sim/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace rbs {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Sums {
  double volume = 0.0;
  Vec3 moments_per_mass = Vec3::Zero();
  Vec3 centre = Vec3::Zero();
};

/// Volume and moments by adding up n³ cells of a cube of edge 2 that lie inside the shape.
Sums addCells(const std::function<bool(const Vec3&)>& inside) {
  constexpr int n = 120;
  const double edge = 2.0 / n;
  Sums sums;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) {
        const Vec3 p = Vec3(i + 0.5, j + 0.5, k + 0.5) * edge - Vec3::Ones();
        if (!inside(p)) continue;
        sums.volume += edge * edge * edge;
        sums.centre += p * edge * edge * edge;
        sums.moments_per_mass += (Vec3::Constant(p.squaredNorm()) - p.cwiseAbs2()) * edge * edge * edge;
      }
    }
  }
  sums.moments_per_mass /= sums.volume;
  sums.centre /= sums.volume;
  return sums;
}

TEST(Shapes, sphereMassMatchesSumOverCells) {
  const Sphere sphere{0.9};
  const Sums sums = addCells([&](const Vec3& p) { return p.norm() < sphere.radius; });
  EXPECT_NEAR(volume(sphere), sums.volume, 2e-3 * sums.volume);
  EXPECT_TRUE(momentsPerMass(sphere).isApprox(sums.moments_per_mass, 2e-3));
}

TEST(Shapes, boxMassMatchesSumOverCells) {
  const Box box{Vec3(0.5, 1.0, 1.5)};
  const Sums sums = addCells([&](const Vec3& p) { return (p.cwiseAbs() - 0.5 * box.size).maxCoeff() < 0.0; });
  EXPECT_NEAR(volume(box), sums.volume, 1e-9);
  EXPECT_TRUE(momentsPerMass(box).isApprox(sums.moments_per_mass, 1e-3));
}

TEST(Shapes, roundMassMatchesSumOverCells) {
  const Capsule capsule{0.4, 0.5};
  const auto inCapsule = [&](const Vec3& p) {
    const double beyond = std::max(std::abs(p.z()) - capsule.half_length, 0.0);
    return Vec3(p.x(), p.y(), beyond).norm() < capsule.radius;
  };
  const Cylinder cylinder{0.7, 0.5};
  const auto inCylinder = [&](const Vec3& p) {
    return p.head<2>().norm() < cylinder.radius && std::abs(p.z()) < cylinder.half_length;
  };
  const Cone cone{0.9, 1.2};
  const auto inCone = [&](const Vec3& p) {
    return p.z() > -0.25 * cone.height && p.head<2>().norm() < cone.radius * (0.75 - p.z() / cone.height);
  };
  const std::pair<Shape, std::function<bool(const Vec3&)>> solids[] = {
      {capsule, inCapsule}, {cylinder, inCylinder}, {cone, inCone}};
  for (const auto& [shape, inside] : solids) {
    const Sums sums = addCells(inside);
    EXPECT_NEAR(volume(shape), sums.volume, 3e-3 * sums.volume) << shapeName(shape);
    EXPECT_TRUE(momentsPerMass(shape).isApprox(sums.moments_per_mass, 3e-3)) << shapeName(shape);
    EXPECT_LT(sums.centre.norm(), 3e-3) << shapeName(shape);
  }
}

/// Points all over the surface of a shape that is round about z.
std::vector<Vec3> surfaceOf(const Shape& shape) {
  std::vector<Vec3> points;
  const auto ring = [&](double r, double z) {
    for (int k = 0; k < 72; ++k)
      points.push_back({r * std::cos(k * kPi / 36), r * std::sin(k * kPi / 36), z});
  };
  constexpr int n = 90;
  for (int i = 0; i <= n; ++i) {
    const double t = static_cast<double>(i) / n;
    if (const auto* c = std::get_if<Cylinder>(&shape)) {
      ring(c->radius, (2.0 * t - 1.0) * c->half_length);
      for (const double z : {-c->half_length, c->half_length}) ring(t * c->radius, z);
    } else if (const auto* cone = std::get_if<Cone>(&shape)) {
      ring((1.0 - t) * cone->radius, (t - 0.25) * cone->height);
      ring(t * cone->radius, -0.25 * cone->height);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      ring(capsule->radius, (2.0 * t - 1.0) * capsule->half_length);
      const double r = capsule->radius * std::cos(0.5 * kPi * t),
                   z = capsule->radius * std::sin(0.5 * kPi * t);
      ring(r, z + capsule->half_length);
      ring(r, -z - capsule->half_length);
    }
  }
  return points;
}

TEST(Shapes, boundsAndReachAreThoseOfTheSurface) {
  for (const Shape& shape : {Shape(Capsule{0.3, 0.8}), Shape(Capsule{0.3, 0.0}), Shape(Cylinder{0.5, 0.2}),
                             Shape(Cylinder{0.1, 0.9}), Shape(Cone{0.7, 0.4}), Shape(Cone{0.2, 1.5})}) {
    const std::vector<Vec3> surface = surfaceOf(shape);
    double farthest = 0.0, nearest = kInfinity;
    Aabb bounds{surface[0], surface[0]};
    for (const Vec3& p : surface) {
      farthest = std::max(farthest, p.norm());
      nearest = std::min(nearest, p.norm());
      bounds = {bounds.lo.cwiseMin(p), bounds.hi.cwiseMax(p)};
    }
    const double size = boundingRadius(shape);
    EXPECT_NEAR(size, farthest, 1e-14) << shapeName(shape);
    EXPECT_NEAR(innerRadius(shape), nearest, 1e-4 * size) << shapeName(shape);
    EXPECT_LE(innerRadius(shape), nearest + 1e-15) << shapeName(shape);
    EXPECT_TRUE(localBounds(shape).lo.isApprox(bounds.lo, 1e-14)) << shapeName(shape);
    EXPECT_TRUE(localBounds(shape).hi.isApprox(bounds.hi, 1e-14)) << shapeName(shape);
    EXPECT_TRUE(fullExtents(shape).isApprox(bounds.hi - bounds.lo, 1e-14)) << shapeName(shape);
    for (int k = 0; k < 200; ++k) {
      const Vec3 d(std::sin(0.7 * k), std::cos(1.3 * k), std::sin(2.1 * k + 1.0));
      double most = -kInfinity;
      for (const Vec3& p : surface) most = std::max(most, d.dot(p));
      EXPECT_NEAR(reach(shape, d), most, 2e-3 * size * d.norm()) << shapeName(shape);
      EXPECT_GE(reach(shape, d), most - 1e-14) << shapeName(shape);
      EXPECT_DOUBLE_EQ(reach(shape, d), d.dot(supportPoint(shape, d)));
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(reach(shape, Vec3::Unit(axis)), localBounds(shape).hi[axis]) << shapeName(shape);
      EXPECT_EQ(reach(shape, -Vec3::Unit(axis)), -localBounds(shape).lo[axis]) << shapeName(shape);
    }
  }
}

TEST(Shapes, surfaceMatchesClosedFormsAndLimits) {
  EXPECT_DOUBLE_EQ(surfaceArea(Capsule{0.3, 0.0}), surfaceArea(Sphere{0.3}));
  EXPECT_NEAR(surfaceArea(Cylinder{0.3, 1e-9}), 2.0 * kPi * 0.09, 1e-8);
  EXPECT_NEAR(surfaceArea(Cone{0.3, 1e-9}), 2.0 * kPi * 0.09, 1e-8);
  EXPECT_DOUBLE_EQ(surfaceArea(Cone{3.0, 4.0}), kPi * 3.0 * (3.0 + 5.0));
  EXPECT_DOUBLE_EQ(surfaceArea(Box{Vec3(1, 2, 3)}), 22.0);
}

TEST(Shapes, extentsAndRadii) {
  const Shape sphere = Sphere{0.3};
  EXPECT_EQ(fullExtents(sphere), Vec3::Constant(0.6));
  EXPECT_EQ(boundingRadius(sphere), 0.3);
  EXPECT_EQ(innerRadius(sphere), 0.3);
  EXPECT_EQ(characteristicLength(sphere), 0.6);

  const Shape box = Box{Vec3(2.0, 3.0, 6.0)};
  EXPECT_EQ(fullExtents(box), Vec3(2.0, 3.0, 6.0));
  EXPECT_DOUBLE_EQ(boundingRadius(box), 3.5);
  EXPECT_EQ(innerRadius(box), 1.0);
  EXPECT_EQ(characteristicLength(box), 2.0);
}

TEST(Shapes, planeIsEndlessAndMassless) {
  const Shape plane = Plane{};
  EXPECT_EQ(volume(plane), 0.0);
  EXPECT_EQ(momentsPerMass(plane), Vec3::Zero());
  EXPECT_EQ(fullExtents(plane), Vec3::Zero());
  EXPECT_EQ(boundingRadius(plane), kInfinity);
  EXPECT_EQ(innerRadius(plane), kInfinity);
  EXPECT_EQ(characteristicLength(plane), kInfinity);
}

TEST(Shapes, scaledShapeHasScaledExtents) {
  EXPECT_EQ(fullExtents(scaled(Sphere{0.25}, 3.0)), Vec3::Constant(1.5));
  EXPECT_EQ(fullExtents(scaled(Box{Vec3(1.0, 2.0, 3.0)}, 0.5)), Vec3(0.5, 1.0, 1.5));
  EXPECT_EQ(shapeName(scaled(Plane{}, 2.0)), "plane");
  for (const Shape& shape : {Shape(Capsule{0.25, 0.5}), Shape(Cylinder{0.5, 0.25}), Shape(Cone{0.5, 2.0})}) {
    EXPECT_EQ(fullExtents(scaled(shape, 4.0)), 4.0 * fullExtents(shape)) << shapeName(shape);
    EXPECT_EQ(volume(scaled(shape, 4.0)), 64.0 * volume(shape)) << shapeName(shape);
  }
}

TEST(Shapes, nameAndExtentsMakeTheSameShape) {
  for (const Shape& shape : {Shape(Sphere{0.7}), Shape(Box{Vec3(1.0, 2.0, 3.0)}), Shape(Plane{}),
                             Shape(Capsule{0.25, 0.75}), Shape(Cylinder{0.3, 0.7}), Shape(Cone{0.3, 0.7})}) {
    const Shape again = makeShape(shapeName(shape), fullExtents(shape), "body");
    EXPECT_EQ(shapeName(again), shapeName(shape));
    EXPECT_TRUE(sameShape(again, shape)) << shapeName(shape);
  }
}

TEST(Shapes, zeroExtentMeansDefault) {
  EXPECT_EQ(fullExtents(makeShape("sphere", Vec3::Zero(), "body")), Vec3::Constant(0.5));
  EXPECT_EQ(fullExtents(makeShape("sphere", Vec3(2.0, 0.0, 0.0), "body")), Vec3::Constant(2.0));
  EXPECT_EQ(fullExtents(makeShape("box", Vec3(0.0, 2.0, 0.0), "body")), Vec3(0.5, 2.0, 0.5));
  EXPECT_EQ(fullExtents(makeShape("capsule", Vec3::Zero(), "body")), Vec3(0.25, 0.25, 0.5));
  EXPECT_EQ(fullExtents(makeShape("capsule", Vec3(2.0, 0.0, 0.0), "body")), Vec3(2.0, 2.0, 4.0));
  EXPECT_EQ(fullExtents(makeShape("cylinder", Vec3(2.0, 2.0, 0.0), "body")), Vec3(2.0, 2.0, 0.5));
  EXPECT_EQ(fullExtents(makeShape("cone", Vec3(0.0, 0.0, 2.0), "body")), Vec3(0.5, 0.5, 2.0));
}

TEST(Shapes, resizedShapeKeepsTheExtentsThatAreZero) {
  EXPECT_EQ(fullExtents(resized(Sphere{}, Vec3(3.0, 0.0, 0.0), "body")), Vec3::Constant(3.0));
  EXPECT_EQ(fullExtents(resized(Box{Vec3(1, 2, 3)}, Vec3(0.0, 5.0, 0.0), "body")), Vec3(1, 5, 3));
  EXPECT_EQ(fullExtents(resized(Capsule{1.0, 1.0}, Vec3(0.0, 0.0, 7.0), "body")), Vec3(2, 2, 7));
  EXPECT_EQ(fullExtents(resized(Cylinder{1.0, 1.0}, Vec3(3.0, 0.0, 0.0), "body")), Vec3(3, 3, 2));
  EXPECT_EQ(fullExtents(resized(Cone{1.0, 5.0}, Vec3(3.0, 3.0, 0.0), "body")), Vec3(3, 3, 5));
  const auto refused = [](const Shape& shape, const Vec3& size) {
    try {
      resized(shape, size, "body");
      return false;
    } catch (const InvalidInput& error) {
      return error.problems().at(0).path == "body.size";
    }
  };
  EXPECT_TRUE(refused(Plane{}, Vec3(1, 1, 1)));
  for (const Shape& shape :
       {Shape(Sphere{}), Shape(Box{}), Shape(Capsule{}), Shape(Cylinder{}), Shape(Cone{})}) {
    for (const Vec3& size : {Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(std::nan(""), 0, 0), Vec3(kInfinity, 1, 1),
                             Vec3(1e-7, 0, 0), Vec3(1e7, 0, 0)}) {
      EXPECT_TRUE(refused(shape, size)) << shapeName(shape) << " " << size.transpose();
    }
  }
  for (const Shape& shape : {Shape(Capsule{}), Shape(Cylinder{}), Shape(Cone{})}) {
    EXPECT_TRUE(refused(shape, Vec3(1, 2, 3))) << shapeName(shape);
  }
  EXPECT_TRUE(refused(Capsule{1.0, 1.0}, Vec3(3.0, 3.0, 2.0)));  // shorter than wide
}

TEST(Shapes, sameShapeMeansTheSameBits) {
  EXPECT_TRUE(sameShape(Cone{1.0, 2.0}, Cone{1.0, 2.0}));
  EXPECT_FALSE(sameShape(Cone{1.0, 2.0}, Cone{1.0, std::nextafter(2.0, 3.0)}));
  EXPECT_FALSE(sameShape(Cylinder{1.0, 1.0}, Cone{1.0, 2.0}));
  EXPECT_FALSE(sameShape(Capsule{1.0, 0.5}, Capsule{1.0, std::nextafter(0.5, 1.0)}));
}

TEST(Shapes, badShapeIsRefusedByPath) {
  const auto pathOfFault = [](const std::string& name, const Vec3& size) -> std::string {
    try {
      makeShape(name, size, "body");
      return "";
    } catch (const InvalidInput& error) {
      return error.problems().at(0).path;
    }
  };
  EXPECT_EQ(pathOfFault("ball", Vec3::Ones()), "body.shape");
  EXPECT_EQ(pathOfFault("sphere", Vec3(1.0, 2.0, 0.0)), "body.size");
  EXPECT_EQ(pathOfFault("sphere", Vec3(-1.0, 0.0, 0.0)), "body.size");
  EXPECT_EQ(pathOfFault("sphere", Vec3(std::nan(""), 0.0, 0.0)), "body.size");
  EXPECT_EQ(pathOfFault("sphere", Vec3(1.0, std::nan(""), 0.0)), "body.size");
  EXPECT_EQ(pathOfFault("box", Vec3(1.0, 1.0, kInfinity)), "body.size");
  EXPECT_EQ(pathOfFault("box", Vec3(1.0, std::nan(""), 1.0)), "body.size");
  EXPECT_EQ(pathOfFault("box", Vec3(1.0, 1e-300, 1.0)), "body.size");
  EXPECT_EQ(pathOfFault("box", Vec3(1.0, 1e300, 1.0)), "body.size");
  EXPECT_EQ(pathOfFault("plane", Vec3(1.0, 0.0, 0.0)), "body.size");
  EXPECT_EQ(pathOfFault("cylinder", Vec3(1.0, 2.0, 1.0)), "body.size");
  EXPECT_EQ(pathOfFault("cone", Vec3(1.0, 1.0, -1.0)), "body.size");
  EXPECT_EQ(pathOfFault("cone", Vec3(1.0, 1.0, std::nan(""))), "body.size");
  EXPECT_EQ(pathOfFault("capsule", Vec3(1.0, 1.0, 0.9)), "body.size");
  EXPECT_EQ(pathOfFault("hull", Vec3::Zero()), "body.shape");
}

}  // namespace
}  // namespace rbs

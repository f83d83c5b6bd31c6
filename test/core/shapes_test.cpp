// Mass properties and bounds of the shapes against closed forms and against sums over small cells.
#include "rigid_body_sim/shape.h"

#include "rigid_body_sim/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace rbs {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Sums {
  double volume = 0.0;
  Vec3 moments_per_mass = Vec3::Zero();
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
        sums.moments_per_mass += (Vec3::Constant(p.squaredNorm()) - p.cwiseAbs2()) * edge * edge * edge;
      }
    }
  }
  sums.moments_per_mass /= sums.volume;
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
}

TEST(Shapes, nameAndExtentsMakeTheSameShape) {
  for (const Shape& shape : {Shape(Sphere{0.7}), Shape(Box{Vec3(1.0, 2.0, 3.0)}), Shape(Plane{})}) {
    const Shape again = makeShape(shapeName(shape), fullExtents(shape), "body");
    EXPECT_EQ(shapeName(again), shapeName(shape));
    EXPECT_EQ(fullExtents(again), fullExtents(shape));
  }
}

TEST(Shapes, zeroExtentMeansDefault) {
  EXPECT_EQ(fullExtents(makeShape("sphere", Vec3::Zero(), "body")), Vec3::Constant(0.5));
  EXPECT_EQ(fullExtents(makeShape("sphere", Vec3(2.0, 0.0, 0.0), "body")), Vec3::Constant(2.0));
  EXPECT_EQ(fullExtents(makeShape("box", Vec3(0.0, 2.0, 0.0), "body")), Vec3(0.5, 2.0, 0.5));
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
}

}  // namespace
}  // namespace rbs

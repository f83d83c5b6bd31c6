// SPDX-License-Identifier: BSD-3-Clause
// Manifolds of bodies pressed deep into each other, on the side from which they came.
#include "narrowphase/same_side.h"

#include "narrowphase/collide.h"
#include "narrowphase/separating_axis.h"
#include "shapes/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rbs {
namespace {

double depthOf(const Manifold& manifold) {
  return -leastSeparation(manifold);
}

// A plate lies 3 mm above the lower side of a slab of 20 mm: the short way out is down, the way it came up.
TEST(SameSide, APlateInASlabPartsTheWayItCame) {
  const Shape slab = Box{{2.0, 2.0, 0.02}}, plate = Box{{0.4, 0.3, 0.004}};
  Pose X_WA, X_WB;
  X_WB.p_WB = Vec3(0.1, 0.0, -0.005);
  const Manifold nearest = collide(slab, X_WA, plate, X_WB, 0.0);
  EXPECT_LT(nearest.n_W.z(), -0.999);
  EXPECT_NEAR(depthOf(nearest), 0.007, 1e-12);
  const Manifold manifold = manifoldOnSide(Vec3::UnitZ(), slab, X_WA, plate, X_WB, 0.0);
  ASSERT_EQ(manifold.size, 4);
  EXPECT_NEAR((manifold.n_W - Vec3::UnitZ()).norm(), 0.0, 1e-12);
  for (int k = 0; k < 4; ++k) {
    const ManifoldPoint& point = manifold.points[k];
    EXPECT_NEAR(point.separation, -0.017, 1e-12) << "from the top of the slab to the bottom of the plate";
    EXPECT_NEAR(point.p_W.z(), 0.5 * (0.01 - 0.007), 1e-12) << "midway between the two surfaces";
    EXPECT_NEAR(std::abs(point.p_W.x() - 0.1), 0.2, 1e-12);
    EXPECT_NEAR(std::abs(point.p_W.y()), 0.15, 1e-12);
  }
}

// Against supports: moved by its depth along its normal, B touches A and no more; and where the nearest manifold has
// the given normal, it is found again.
TEST(SameSide, RandomPairsPartAlongTheNormalThatIsFound) {
  std::mt19937 random(17);
  std::uniform_real_distribution<> length(0.05, 0.5);
  std::normal_distribution<> normal;
  const auto anyShape = [&]() -> Shape {
    switch (random() % 5) {
      case 0:
        return Sphere{length(random)};
      case 1:
        return Capsule{length(random), length(random)};
      case 2:
        return Cylinder{length(random), length(random)};
      case 3:
        return Cone{length(random), length(random)};
      default:
        return Box{{length(random), length(random), length(random)}};
    }
  };
  const auto anyPose = [&](double far) {
    Pose X;
    X.p_WB = far * Vec3(normal(random), normal(random), normal(random));
    X.q_WB = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    return X;
  };
  int overlapping = 0;
  for (int k = 0; k < 2000; ++k) {
    const Shape a = anyShape(), b = anyShape();
    const Pose X_WA = anyPose(0.1), X_WB = anyPose(0.1);
    const Vec3 n_W = Vec3(normal(random), normal(random), normal(random)).normalized();
    if (gap(a, X_WA, b, X_WB).distance >= 0.0) continue;
    ++overlapping;
    const Manifold manifold = manifoldOnSide(n_W, a, X_WA, b, X_WB, 1e-6);
    ASSERT_GT(manifold.size, 0) << k;
    EXPECT_GT(manifold.n_W.dot(n_W), 0.0) << k;
    Pose parted = X_WB;
    parted.p_WB += depthOf(manifold) * manifold.n_W;
    EXPECT_NEAR(separationAlong(manifold.n_W, a, X_WA, b, parted), 0.0, 1e-6) << k;

    const Manifold nearest = collide(a, X_WA, b, X_WB, 0.0);
    ASSERT_GT(nearest.size, 0) << k;
    const Manifold again = manifoldOnSide(nearest.n_W, a, X_WA, b, X_WB, 1e-6);
    EXPECT_NEAR(depthOf(again), depthOf(nearest), 1e-6) << k;
  }
  EXPECT_GT(overlapping, 1000);
}

}  // namespace
}  // namespace rbs

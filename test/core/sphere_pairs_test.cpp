// SPDX-License-Identifier: BSD-3-Clause
// Spheres against spheres, boxes and planes: closed forms, inside and out.
#include "core/narrowphase_oracles.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

Pose at(const Vec3& p, const Quat& q = Quat::Identity()) {
  return {p, q};
}

void expectPoint(const Manifold& manifold, const Vec3& n, const Vec3& p, double separation) {
  ASSERT_EQ(manifold.size, 1);
  EXPECT_TRUE(manifold.n_W.isApprox(n, 1e-14)) << manifold.n_W.transpose();
  EXPECT_TRUE(manifold.points[0].p_W.isApprox(p, 1e-14)) << manifold.points[0].p_W.transpose();
  EXPECT_NEAR(manifold.points[0].separation, separation, 1e-14);
}

TEST(SphereSphere, MeetsBetweenTheCentres) {
  const Sphere a{1.0}, b{0.5};
  expectPoint(collide(a, at({0, 0, 0}), b, at({0, 1.6, 0}), 0.2), Vec3::UnitY(), {0, 1.05, 0}, 0.1);
  expectPoint(collide(a, at({0, 0, 0}), b, at({0, 1.4, 0}), 0.0), Vec3::UnitY(), {0, 0.95, 0}, -0.1);
  EXPECT_EQ(collide(a, at({0, 0, 0}), b, at({0, 1.8, 0}), 0.2).size, 0);
  EXPECT_DOUBLE_EQ(gap(a, at({0, 0, 0}), b, at({0, 0, 4})).distance, 2.5);
}

TEST(SphereSphere, CoincidentCentresHaveOneNormal) {
  expectPoint(collide(Sphere{1.0}, at({3, 4, 5}), Sphere{0.5}, at({3, 4, 5}), 0.0), Vec3::UnitZ(),
              {3, 4, 5.25}, -1.5);
}

TEST(SphereBox, MeetsFaceEdgeAndCorner) {
  const Sphere ball{0.5};
  const Box box{Vec3(2, 4, 6)};
  expectPoint(collide(ball, at({1.6, 0.5, 0.5}), box, at({0, 0, 0}), 0.2), -Vec3::UnitX(), {1.05, 0.5, 0.5},
              0.1);
  const Vec3 edge = Vec3(3, 4, 0) / 5.0;
  expectPoint(collide(ball, at(Vec3(1, 2, 0.5) + 0.4 * edge), box, at({0, 0, 0}), 0.0), -edge,
              Vec3(1, 2, 0.5) - 0.05 * edge, -0.1);
  const Vec3 corner = Vec3(1, 2, 2) / 3.0;
  expectPoint(collide(ball, at(Vec3(1, 2, 3) + 0.6 * corner), box, at({0, 0, 0}), 0.2), -corner,
              Vec3(1, 2, 3) + 0.05 * corner, 0.1);
}

TEST(SphereBox, LeavesThroughTheNearestFace) {
  const Sphere ball{0.5};
  const Box box{Vec3(2, 4, 6)};
  // The centre 0.1 below the face x = 1: the box's surface is 0.6 behind that of the sphere.
  expectPoint(collide(ball, at({0.9, 0.3, -0.2}), box, at({0, 0, 0}), 0.0), -Vec3::UnitX(), {0.7, 0.3, -0.2},
              -0.6);
  expectPoint(collide(ball, at({-0.9, 0.3, -0.2}), box, at({0, 0, 0}), 0.0), Vec3::UnitX(), {-0.7, 0.3, -0.2},
              -0.6);
  expectPoint(collide(ball, at({0, 0, 0}), box, at({0, 0, 0}), 0.0), -Vec3::UnitX(), {0.25, 0, 0}, -1.5);
}

TEST(SphereBox, IsContinuousThroughTheSurface) {
  const Sphere ball{0.5};
  const Box box{Vec3(2, 4, 6)};
  for (const double depth : {-1e-3, -1e-9, -1e-15, 0.0, 1e-15, 1e-9, 1e-3}) {
    const Gap found = gap(ball, at({0.2, 2.0 + depth, 0.1}), box, at({0, 0, 0}));
    EXPECT_NEAR(found.distance, depth - 0.5, 1e-15) << depth;
    EXPECT_TRUE(found.n_W.isApprox(-Vec3::UnitY())) << depth;
  }
}

TEST(SphereBox, GapMatchesTheClampedCentre) {
  const std::uint64_t seed = 41;
  Random random(seed);
  for (int k = 0; k < 5000; ++k) {
    const Sphere ball{random.uniform(0.01, 1.0)};
    const Box box = random.box();
    const Pose X_WA = random.pose(1.0), X_WB = random.pose(1.0);
    const double centre =
        static_cast<double>(oracle::PlacedBox(box, X_WB).distanceTo(X_WA.p_WB.cast<oracle::Real>()));
    const Gap found = gap(ball, X_WA, box, X_WB);
    if (centre > 0.0) {
      ASSERT_NEAR(found.distance, centre - ball.radius, 1e-14) << "seed " << seed << ", pair " << k;
    } else {
      ASSERT_LT(found.distance, -ball.radius) << "seed " << seed << ", pair " << k;
    }
  }
}

TEST(SpherePlane, MeasuresTheHeight) {
  const Quat wall(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitY()));  // its outside is +x
  expectPoint(collide(Sphere{0.5}, at({2.6, 7, 8}), Plane{}, at({2, 0, 0}, wall), 0.2), -Vec3::UnitX(),
              {2.05, 7, 8}, 0.1);
  expectPoint(collide(Sphere{0.5}, at({1.0, 7, 8}), Plane{}, at({2, 0, 0}, wall), 0.0), -Vec3::UnitX(),
              {1.25, 7, 8}, -1.5);
  EXPECT_EQ(collide(Sphere{0.5}, at({2.8, 7, 8}), Plane{}, at({2, 0, 0}, wall), 0.2).size, 0);
}

}  // namespace
}  // namespace rbs

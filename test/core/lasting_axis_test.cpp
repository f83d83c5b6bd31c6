// SPDX-License-Identifier: BSD-3-Clause
// The normal of two that lean on each other with their edges.
#include "narrowphase/lasting_axis.h"

#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <random>

namespace rbs {
namespace {

// Two planks that lean on each other like a roof. Their upper edges meet along the y axis, where they are apart by `gap`
// along the face of the first.
struct Roof {
  Shape a, b;
  Motion on_a, on_b;
  Vec3 face_a_W, face_b_W;  // the normals of the two faces that meet there, from A to B
};

Shape hullOf(const Vec3& size) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(0.5 *
                      size.cwiseProduct(Vec3(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0)));
  return makeHull(corners, "plank").hull;
}

Roof roof(double angle, double thickness, double gap, bool hull) {
  const Vec3 size(thickness, 0.2, 0.4);
  Roof roof;
  roof.a = roof.b = hull ? hullOf(size) : Shape(Box{size});
  const auto lean = [&](Motion& motion, double to, const Vec3& corner) {
    motion.pose.q_WB = Quat(Eigen::AngleAxisd(to, Vec3::UnitY()));
    motion.pose.p_WB = -(motion.pose.q_WB * corner);
  };
  lean(roof.on_a, angle, {0.5 * thickness, 0.0, 0.2});
  lean(roof.on_b, -angle, {-0.5 * thickness, 0.0, 0.2});
  roof.face_a_W = roof.on_a.pose.q_WB * Vec3::UnitX();
  roof.face_b_W = roof.on_b.pose.q_WB * Vec3::UnitX();
  roof.on_b.pose.p_WB += gap * roof.face_a_W;
  return roof;
}

Manifold manifoldOf(const Roof& roof, const Vec3& loaded_W) {
  SeparatingAxis axis;
  const LastingLimits limits{1e-7 * 0.002, 1e-10, 1e-6};
  return lastingManifold(roof.a, roof.on_a, roof.b, roof.on_b, 0.0, 1.0 / 60.0, 1e-3, limits, loaded_W, axis);
}

TEST(LastingAxis, ANormalThatBearsStaysWhereRoundingWouldChooseAnother) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> angle(0.1, 0.7), thickness(0.002, 0.05), rounding(-1e-12, 1e-12);
  int others = 0;
  for (int k = 0; k < 400; ++k) {
    const Roof one = roof(angle(random), thickness(random), rounding(random), k % 2 == 1);
    for (const Vec3& loaded_W : {one.face_a_W, one.face_b_W}) {
      const Manifold manifold = manifoldOf(one, loaded_W);
      ASSERT_LE((manifold.n_W - loaded_W).norm(), 1e-9) << k;
      EXPECT_GE(manifold.size, 2) << "the two ends of the edge";
      EXPECT_NEAR(leastSeparation(manifold),
                  separationAlong(loaded_W, one.a, one.on_a.pose, one.b, one.on_b.pose), 1e-12);
    }
    others += manifoldOf(one, Vec3::Zero()).n_W.dot(one.face_b_W) < 1.0 - 1e-6 ? 1 : 0;
  }
  EXPECT_GT(others, 100) << "without a force the nearest axis is often another one";
}

// 0.1 mm further along the face of the second.
TEST(LastingAxis, ANormalGoesThatSeparatesTheTwoLess) {
  for (const bool hull : {false, true}) {
    Roof one = roof(0.4, 0.002, 0.0, hull);
    one.on_b.pose.p_WB += 1e-4 * one.face_b_W - 1e-4 * one.face_a_W;
    EXPECT_GT(manifoldOf(one, one.face_a_W).n_W.dot(one.face_b_W), 1.0 - 1e-9) << hull;
  }
}

// A cube on the edge of another one that has gone past it holds nothing there, however deep its soft contact had sunk in.
TEST(LastingAxis, AFaceHoldsNothingBesideIt) {
  const Vec3 size = Vec3::Constant(0.1);
  const LastingLimits soft{4e-3, 1e-3, 0.1};
  for (const bool hull : {false, true})
    for (const double past : {1e-5, 1e-4, 1e-3}) {
      const Shape cube = hull ? hullOf(size) : Shape(Box{size});
      Motion below, above;
      above.pose.p_WB = Vec3(0.1 + past, 0.0, 0.1 - 1e-4);
      SeparatingAxis axis;
      const Manifold manifold =
          lastingManifold(cube, below, cube, above, 0.0, 1.0 / 60.0, 1e-2, soft, Vec3::UnitZ(), axis);
      EXPECT_LT(manifold.n_W.z(), 0.9) << "past by " << past << (hull ? ", hulls" : ", boxes");
    }
}

}  // namespace
}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// GJK against enumeration in long double, and the places where such code is known to break.
#include "narrowphase/gjk.h"

#include "core/narrowphase_oracles.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

struct SegmentCore {
  double half;
  Vec3 operator()(const Vec3& d) const { return {std::copysign(half, d.x()), 0.0, 0.0}; }
};

template <class A, class B>
GjkResult distanceOf(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB) {
  const CoreDifference difference(a, b, RelativePose(X_WA, X_WB));
  return gjk(difference, difference.centre());
}

bool inside(const Vec3& p, const Vec3& half, double tolerance) {
  return (p.cwiseAbs() - half).maxCoeff() <= tolerance;
}

TEST(Gjk, FindsTheDistanceOfBoxes) {
  const std::uint64_t seed = 11;
  Random random(seed);
  int apart = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.7), X_WB = random.pose(0.7);
    const oracle::PlacedBox box_a(a, X_WA), box_b(b, X_WB);
    if (oracle::farthestSeparation(box_a, box_b) <= 1e-13L) continue;
    ++apart;
    const GjkResult result = distanceOf(coreOf(a), X_WA, coreOf(b), X_WB);
    const double truth = static_cast<double>(oracle::boxDistance(box_a, box_b));
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    ASSERT_FALSE(result.overlap) << where;
    ASSERT_NEAR(result.upper, truth, 1e-14 + 1e-12 * truth) << where;
    ASSERT_LE(result.lower, truth + 1e-14) << where;
    ASSERT_GE(result.lower, truth - 1e-8) << where;
    ASSERT_LT(result.iterations, 30) << where;
    const RelativePose X_AB(X_WA, X_WB);
    const Vec3 on_a = result.simplex.witnessA(), on_b = result.simplex.witnessB();
    ASSERT_TRUE(inside(on_a, 0.5 * a.size, 1e-13)) << where;
    ASSERT_TRUE(inside(X_AB.R_AB.transpose() * (on_b - X_AB.p_AB), 0.5 * b.size, 1e-13)) << where;
    ASSERT_NEAR((on_a - on_b).norm(), result.upper, 1e-13) << where;
  }
  EXPECT_GT(apart, 8000);
}

TEST(Gjk, FindsOverlap) {
  const std::uint64_t seed = 12;
  Random random(seed);
  int overlapping = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
    if (oracle::farthestSeparation({a, X_WA}, {b, X_WB}) >= -1e-13L) continue;
    ++overlapping;
    ASSERT_TRUE(distanceOf(coreOf(a), X_WA, coreOf(b), X_WB).overlap) << "seed " << seed << ", pair " << k;
  }
  EXPECT_GT(overlapping, 2000);
}

// Two unit cubes, one shifted by 1.9 and one by 0.9 along an axis: a start direction in the plane of a face
// must not lose the way (libccd issue 25).
TEST(Gjk, StartsFromAnyDirection) {
  const BoxCore cube{Vec3::Constant(0.5)};
  std::vector<Vec3> starts;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) starts.emplace_back(x, y, z);
  for (const double shift : {1.9, 0.9})
    for (int axis = 0; axis < 3; ++axis)
      for (const Vec3& start : starts) {
        Pose moved;
        moved.p_WB[axis] = shift;
        const GjkResult result = gjk(CoreDifference(cube, cube, RelativePose(Pose(), moved)), start);
        EXPECT_EQ(result.overlap, shift < 1.0)
            << shift << ", axis " << axis << ", start " << start.transpose();
        EXPECT_NEAR(result.upper, std::max(0.0, shift - 1.0), 1e-15);
      }
}

TEST(Gjk, MeasuresPointsAndSegments) {
  Pose away;
  away.p_WB = Vec3(3.0, 4.0, 12.0);
  EXPECT_DOUBLE_EQ(distanceOf(PointCore{}, Pose(), PointCore{}, away).upper, 13.0);
  EXPECT_TRUE(distanceOf(PointCore{}, Pose(), PointCore{}, Pose()).overlap);
  // Crossing at a right angle, one above the other; then in one line, end to end.
  Pose above;
  above.p_WB = Vec3(0.2, 0.3, 0.5);
  above.q_WB = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitZ()));
  EXPECT_NEAR(distanceOf(SegmentCore{1.0}, Pose(), SegmentCore{1.0}, above).upper, 0.5, 1e-15);
  Pose behind;
  behind.p_WB = Vec3(2.5, 0.0, 0.0);
  EXPECT_NEAR(distanceOf(SegmentCore{1.0}, Pose(), SegmentCore{1.0}, behind).upper, 0.5, 1e-15);
  // Parallel, side by side: the nearest points are not unique, their distance is.
  Pose beside;
  beside.p_WB = Vec3(0.3, 0.7, 0.0);
  EXPECT_NEAR(distanceOf(SegmentCore{1.0}, Pose(), SegmentCore{1.0}, beside).upper, 0.7, 1e-15);
}

TEST(Gjk, DoesNotDependOnScale) {
  const std::uint64_t seed = 13;
  Random random(seed);
  for (int k = 0; k < 500; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(1.0), X_WB = random.pose(1.0);
    const GjkResult one = distanceOf(coreOf(a), X_WA, coreOf(b), X_WB);
    for (const int exponent : {-20, 20}) {  // powers of two round alike
      const double scale = std::ldexp(1.0, exponent);
      const GjkResult other = distanceOf(coreOf(Box{scale * a.size}), {scale * X_WA.p_WB, X_WA.q_WB},
                                         coreOf(Box{scale * b.size}), {scale * X_WB.p_WB, X_WB.q_WB});
      ASSERT_EQ(other.upper, scale * one.upper) << "seed " << seed << ", pair " << k;
      ASSERT_EQ(other.iterations, one.iterations) << "seed " << seed << ", pair " << k;
    }
  }
}

// The simplex solver by itself, on simplices without volume, area or length.
TEST(Simplex, SurvivesDegeneracy) {
  const auto nearest = [](std::initializer_list<Vec3> points) {
    Simplex simplex;
    for (const Vec3& p : points) simplex.add({p, p, Vec3::Zero()});
    return reduceToNearest(simplex);
  };
  const Vec3 p(1.0, 2.0, 2.0), q(1.0, -2.0, -2.0), middle(1.0, 0.0, 0.0);
  EXPECT_EQ(nearest({p, p}), p);
  EXPECT_TRUE(nearest({p, middle, q}).isApprox(middle));
  EXPECT_TRUE(nearest({p, q, p, q}).isApprox(middle));
  EXPECT_TRUE(nearest({Vec3(1, 1, 0), Vec3(1, -1, 0), Vec3(2, 0, 0), Vec3(3, 0, 0)}).isApprox(middle));
  EXPECT_TRUE(
      nearest({Vec3(1, 1, 1), Vec3(1, -1, 1), Vec3(1, 0, -1), Vec3(1 + 1e-16, 0.1, 0.2)}).isApprox(middle));
  EXPECT_EQ(nearest({Vec3(1, 1, 1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1)}), Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// EPA against the fifteen axes in long double, and from every kind of start.
#include "narrowphase/epa.h"

#include "core/narrowphase_oracles.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

TEST(Epa, FindsTheDepthOfBoxes) {
  const std::uint64_t seed = 21;
  Random random(seed);
  int overlapping = 0;
  for (int k = 0; k < 10000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
    const oracle::PlacedBox box_a(a, X_WA), box_b(b, X_WB);
    const double truth = static_cast<double>(oracle::farthestSeparation(box_a, box_b));
    if (truth >= -1e-12) continue;
    ++overlapping;
    const Gap gap = gapConvex(a, X_WA, b, X_WB);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    ASSERT_NEAR(gap.distance, truth, 1e-12) << where;
    ASSERT_NEAR(gap.n_W.norm(), 1.0, 1e-14) << where;
    const double along =
        static_cast<double>(oracle::separationAlong(box_a, box_b, gap.n_W.cast<oracle::Real>()));
    ASSERT_NEAR(along, gap.distance, 1e-12) << where;
  }
  EXPECT_GT(overlapping, 1000);
}

// Moving B by the depth along n leaves the boxes touching; the witnesses are as deep as the depth says.
TEST(Epa, GivesWitnessesAndCertificate) {
  const std::uint64_t seed = 22;
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    const Box a{Vec3::Ones()}, b{Vec3(0.5, 1.0, 2.0)};
    const RelativePose X_AB(random.pose(0.2), random.pose(0.2));
    const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
    const GjkResult start = gjk(difference, difference.centre());
    ASSERT_TRUE(start.overlap);
    const EpaResult result = epa(difference, start.simplex, start.scale);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    ASSERT_GT(result.upper, 0.0) << where;
    ASSERT_NEAR(result.lower, result.upper, 1e-13) << where;
    ASSERT_LT(result.iterations, 60) << where;
    ASSERT_TRUE((result.a - result.b).isApprox(result.upper * result.n, 1e-10)) << where;
    ASSERT_LE((result.a.cwiseAbs() - 0.5 * a.size).maxCoeff(), 1e-13) << where;
    const Vec3 b_B = X_AB.R_AB.transpose() * (result.b - X_AB.p_AB);
    ASSERT_LE((b_B.cwiseAbs() - 0.5 * b.size).maxCoeff(), 1e-13) << where;
    for (int d = 0; d < 20; ++d) {  // no direction separates sooner
      const Vec3 direction = random.direction();
      ASSERT_GE(direction.dot(difference(direction).w), result.upper - 1e-13) << where;
    }
  }
}

// The origin may lie on a corner, an edge, a face or inside of the first simplex.
TEST(Epa, StartsFromEverySimplex) {
  const auto cube = [](const Vec3& centre) {
    return [centre](const Vec3& d) {
      const Vec3 w = centre + BoxCore{Vec3(1.0, 2.0, 3.0)}(d);
      return SupportPoint{w, w, Vec3::Zero(), Vec3::Zero(), false};
    };
  };
  const auto corner = [](const Vec3& w) { return SupportPoint{w, w, Vec3::Zero(), Vec3::Zero(), false}; };
  {  // inside, from a segment, a triangle and a tetrahedron through the origin
    const auto support = cube(Vec3::Zero());
    Simplex s;
    s.add(corner({1, 2, 3})), s.add(corner({-1, -2, -3}));
    EXPECT_NEAR(epa(support, s, 3.0).upper, 1.0, 1e-14);
    s.add(corner({1, -2, 3}));
    EXPECT_NEAR(epa(support, s, 3.0).upper, 1.0, 1e-14);
    s.add(corner({-1, 2, 3}));
    EXPECT_NEAR(epa(support, s, 3.0).upper, 1.0, 1e-14);
    EXPECT_NEAR(std::abs(epa(support, s, 3.0).n.x()), 1.0, 1e-14);
  }
  // on the middle of a face, of an edge, and on a corner: depth 0
  const auto touching = [&](const Vec3& centre, std::initializer_list<Vec3> corners) {
    Simplex s;
    for (const Vec3& w : corners) s.add(corner(w));
    const EpaResult result = epa(cube(centre), s, 6.0);
    EXPECT_NEAR(result.upper, 0.0, 1e-14) << centre.transpose();
    EXPECT_NEAR(result.n.norm(), 1.0, 1e-14) << centre.transpose();
    EXPECT_LE(result.n.dot(centre), 1e-14) << centre.transpose();
  };
  touching({1, 0, 0}, {{0, 2, 3}, {0, -2, -3}});
  touching({1, 2, 0}, {{0, 0, 3}, {0, 0, -3}});
  touching({1, 2, 3}, {{0, 0, 0}});
}

// Two crossing segments: their difference is a parallelogram, with depth 0 along its normal.
TEST(Epa, GivesTheNormalOfAFlatDifference) {
  const SupportFunction support = [](const Vec3& d) {
    const Vec3 w(std::copysign(1.0, d.x()), std::copysign(1.0, d.y()), 0.0);
    return SupportPoint{w, w, Vec3::Zero(), Vec3::Zero(), false};
  };
  const GjkResult start = gjk(support, Vec3(0.1, 0.2, 0.0));
  const EpaResult result = epa(support, start.simplex, start.scale);
  EXPECT_EQ(result.upper, 0.0);
  EXPECT_NEAR(std::abs(result.n.z()), 1.0, 1e-14);
}

// Every height at which a cube may sit on another, from deep to barely apart: the sign and the normal hold.
TEST(Epa, IsContinuousThroughTouching) {
  const Box cube{Vec3::Ones()};
  Pose above;
  above.q_WB = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
  for (const double gap : {-0.5, -1e-3, -1e-9, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-3}) {
    above.p_WB = Vec3(0.1, -0.2, 1.0 + gap);
    const Gap found = gapConvex(cube, Pose(), cube, above);
    EXPECT_NEAR(found.distance, gap, 1e-15) << gap;
    EXPECT_NEAR(found.n_W.z(), 1.0, 1e-12) << gap;
  }
}

// Concentric cubes: any face is as near as any other, and the answer is the same every time.
TEST(Epa, ChoosesTheSameFaceEveryTime) {
  const Box cube{Vec3::Ones()};
  const Gap first = gapConvex(cube, Pose(), cube, Pose()), second = gapConvex(cube, Pose(), cube, Pose());
  EXPECT_NEAR(first.distance, -1.0, 1e-14);
  EXPECT_EQ(first.n_W, second.n_W);
}

}  // namespace
}  // namespace rbs

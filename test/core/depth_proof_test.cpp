// SPDX-License-Identifier: BSD-3-Clause
// What is proved of the depth near a stationary direction, against directions drawn at random.
#include "narrowphase/depth_proof.h"

#include "base/algebra.h"
#include "core/narrowphase_oracles.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

struct Count {
  int by_points[4] = {}, by_disc = 0, sloping = 0, by_belt = 0;
};

// Directions from starts at random, and caps of random width about them: where the proof holds no direction
// drawn from the cap is shallower. Likewise the belts.
template <class ShapeA, class ShapeB>
void holdsAgainstSamples(const ShapeA& a, const ShapeB& b, const Pose& X_WB, Random& random, Count& count) {
  const RelativePose X_AB(Pose(), X_WB);
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  const Finish finish(coreOf(a), coreOf(b), X_AB);
  const Vec3 least = convexGap(a, b, X_AB).n_A;
  const auto heightAlong = [&](const Vec3& n) { return n.dot(difference(n).w); };
  for (int k = 0; k < 20; ++k) {
    const Vec3 start =
        k % 2 == 0 ? random.direction() : Vec3((least + 0.1 * random.direction()).normalized());
    const Seek seek = std::array{Seek::Stationary, Seek::PinnedByA, Seek::PinnedByB}[k % 3];
    std::array<SupportPoint, 3> near;
    for (SupportPoint& point : near) point = difference((start + 0.1 * random.direction()).normalized());
    Finished finished = finish(start, near.data(), 3, seek);
    for (const Belt& belt : finished.belts) {
      const double depth = belt.height - std::max(0.0, random.uniform(-0.1, 0.1));
      if (!(depth > 0.0)) continue;
      const double width = provenWidth(belt, depth, 1e-15);
      if (width == 0.0) continue;
      ++count.by_belt;
      const auto [t1, t2] = tangents(belt.axis);
      for (int d = 0; d < 300; ++d) {
        const double turn = std::acos(belt.cosine) + width * random.uniform(-1.0, 1.0),
                     at = random.uniform(0.0, 6.3);
        const Vec3 n = std::cos(turn) * belt.axis + std::sin(turn) * (std::cos(at) * t1 + std::sin(at) * t2);
        ASSERT_GE(heightAlong(n), depth - 1e-14) << "belt about " << belt.axis.transpose();
      }
    }
    if (finished.nearest.size == 0) continue;
    const double height = heightAlong(finished.n);
    const double depth = height - std::max(0.0, random.uniform(-0.1, 0.1));
    const Vec3 touching = reduceToNearest(finished.nearest);
    const bool sloping = (touching - height * finished.n).norm() > 1e-14;
    if (!(depth > 0.0)) continue;
    const double angle = std::pow(10.0, random.uniform(-3.0, 0.3));
    if (!provesDepth(finished, height, depth, angle, 1e-15)) continue;
    ++(finished.margin > 0.0 ? count.by_disc : count.by_points[finished.nearest.size]);
    count.sloping += sloping;
    const auto [t1, t2] = tangents(finished.n);
    for (int d = 0; d < 300; ++d) {
      const double turn = angle * (d % 3 == 0 ? 1.0 : random.uniform(0.0, 1.0)),
                   at = random.uniform(0.0, 6.3);
      const Vec3 n = std::cos(turn) * finished.n + std::sin(turn) * (std::cos(at) * t1 + std::sin(at) * t2);
      ASSERT_GE(heightAlong(n), depth - 1e-14)
          << "depth " << depth << ", angle " << angle << ", turned by " << turn << ", points "
          << finished.nearest.size << ", sought " << static_cast<int>(seek);
    }
  }
}

TEST(DepthProof, NoDirectionItCoversIsShallower) {
  const std::uint64_t seed = 31;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  const auto length = [&] { return random.uniform(0.05, 0.5); };
  Count count;
  for (int k = 0; k < 800; ++k) {
    const Cylinder cylinder{length(), length()}, other{length(), length()};
    const Cone cone{length(), 2.0 * length()}, second{length(), 2.0 * length()};
    const Box box{2.0 * Vec3(length(), length(), length())};
    const Capsule capsule{0.1, length()};
    Pose pose = random.pose(0.4);
    if (k % 2 == 1)  // nearly on one axis
      pose = {0.01 * random.inCube(1.0),
              Quat(Eigen::AngleAxisd(0.02 * random.uniform(0.0, 1.0), random.direction()))};
    holdsAgainstSamples(cylinder, other, pose, random, count);
    holdsAgainstSamples(cone, cylinder, pose, random, count);
    holdsAgainstSamples(cone, second, pose, random, count);
    holdsAgainstSamples(cylinder, box, pose, random, count);
    holdsAgainstSamples(cone, box, pose, random, count);
    holdsAgainstSamples(capsule, cone, pose, random, count);
  }
  EXPECT_GT(count.by_points[1], 50);
  EXPECT_GT(count.by_points[2], 200);
  EXPECT_GT(count.by_points[3], 200);
  EXPECT_GT(count.by_disc, 200);
  EXPECT_GT(count.sloping, 200);
  EXPECT_GT(count.by_belt, 200);
}

// On one axis all directions across it tie, and the second-order condition holds with equality.
TEST(DepthProof, HoldsForTies) {
  const Cylinder a{0.2, 1.0}, b{0.3, 0.7};
  const RelativePose X_AB({}, {});
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  Finished finished;
  finished.n = Vec3::UnitX();
  finished.axis_a = finished.axis_b = Vec3::UnitZ();
  finished.nearest.add(difference(Vec3(1.0, 0.0, 1e-3)));
  finished.nearest.add(difference(Vec3(1.0, 0.0, -1e-3)));
  reduceToNearest(finished.nearest);
  EXPECT_TRUE(provesDepth(finished, 0.5, 0.5, 0.5, 1e-15));
  EXPECT_FALSE(provesDepth(finished, 0.5, 0.501, 0.5, 1e-15));
}

// Solids on one axis, or nearly: EPA has proved the depth when it stops, after few rounds.
TEST(DepthProof, EndsEpaWhereDirectionsTie) {
  const std::uint64_t seed = 32;
  Random random(seed);
  const auto check = [&](const auto& a, const auto& b, const Pose& X_WB, const std::string& where) {
    const RelativePose X_AB(Pose(), X_WB);
    const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
    const Finish finish(coreOf(a), coreOf(b), X_AB);
    const GjkResult start = gjk(difference, difference.centre(), finish);
    ASSERT_TRUE(start.overlap) << where;
    const EpaResult result = epa(difference, start.simplex, start.scale, finish);
    ASSERT_LE(result.upper - result.lower, 1e-13) << where;
    ASSERT_LT(result.iterations, 200) << where;
  };
  for (int k = 0; k < 300; ++k) {
    const auto length = [&] { return random.uniform(0.05, 0.5); };
    const double off = k % 3 == 0 ? 0.0 : std::pow(10.0, random.uniform(-16.0, -9.0));
    const Pose pose{Vec3(0.0, 0.0, 0.01) + off * random.direction(),
                    Quat(Eigen::AngleAxisd(k % 2 == 0 ? off : 0.0, random.direction()))};
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    check(Cylinder{length(), length()}, Cylinder{length(), length()}, pose, where);
    check(Cylinder{length(), 1.0}, Capsule{0.1, length()}, pose, where);
    check(Cone{length(), 1.0}, Capsule{0.1, 0.02}, {pose.p_WB, Quat::Identity()}, where);
  }
}

}  // namespace
}  // namespace rbs

// What is proved of the depth near a stationary direction, against directions drawn at random.
#include "narrowphase/depth_proof.h"

#include "algebra.h"
#include "core/narrowphase_oracles.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

struct Count {
  int by_points[4] = {};
};

// Stationary directions from starts at random, and caps of random width about them: where the proof holds no
// direction drawn from the cap is shallower.
template <class ShapeA, class ShapeB>
void holdsAgainstSamples(const ShapeA& a, const ShapeB& b, Random& random, Count& count) {
  const RelativePose X_AB(random.pose(0.4), random.pose(0.4));
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  const Finish finish(coreOf(a), coreOf(b), X_AB);
  const Vec3 least = convexGap(a, b, X_AB).n_A;
  for (int k = 0; k < 20; ++k) {
    const Vec3 start =
        k % 2 == 0 ? random.direction() : Vec3((least + 0.1 * random.direction()).normalized());
    std::array<SupportPoint, 3> near;
    for (SupportPoint& point : near) point = difference((start + 0.1 * random.direction()).normalized());
    Finished finished = finish(start, near.data(), 3);
    if (finished.nearest.size == 0) continue;
    const double depth = finished.n.dot(difference(finished.n).w);
    const Vec3 touching = reduceToNearest(finished.nearest);
    if (!(depth > 0.0) || (touching - depth * finished.n).norm() > 1e-14) continue;
    const double angle = std::pow(10.0, random.uniform(-3.0, 0.3));
    if (!provesDepth(finished, depth, angle, 1e-15)) continue;
    ++count.by_points[finished.nearest.size];
    const auto [t1, t2] = tangents(finished.n);
    for (int d = 0; d < 300; ++d) {
      const double turn = angle * (d % 3 == 0 ? 1.0 : random.uniform(0.0, 1.0)),
                   at = random.uniform(0.0, 6.3);
      const Vec3 n = std::cos(turn) * finished.n + std::sin(turn) * (std::cos(at) * t1 + std::sin(at) * t2);
      ASSERT_GE(n.dot(difference(n).w), depth - 1e-14)
          << "depth " << depth << ", angle " << angle << ", turned by " << turn << ", points "
          << finished.nearest.size;
    }
  }
}

TEST(DepthProof, NoDirectionItCoversIsShallower) {
  const std::uint64_t seed = 31;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  const auto length = [&] { return random.uniform(0.05, 0.5); };
  Count count;
  for (int k = 0; k < 400; ++k) {
    const Cylinder cylinder{length(), length()}, other{length(), length()};
    const Cone cone{length(), 2.0 * length()}, second{length(), 2.0 * length()};
    const Box box{2.0 * Vec3(length(), length(), length())};
    holdsAgainstSamples(cylinder, other, random, count);
    holdsAgainstSamples(cone, cylinder, random, count);
    holdsAgainstSamples(cone, second, random, count);
    holdsAgainstSamples(cylinder, box, random, count);
    holdsAgainstSamples(cone, box, random, count);
  }
  EXPECT_GT(count.by_points[1], 50);
  EXPECT_GT(count.by_points[2], 200);
  EXPECT_GT(count.by_points[3], 200);
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
  EXPECT_TRUE(provesDepth(finished, 0.5, 0.5, 1e-15));
  EXPECT_FALSE(provesDepth(finished, 0.501, 0.5, 1e-15));
}

}  // namespace
}  // namespace rbs

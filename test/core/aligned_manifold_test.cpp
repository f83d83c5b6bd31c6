// SPDX-License-Identifier: BSD-3-Clause
// Manifolds of shapes that stand in rows, as bodies in a scene do: faces, edges and axes are parallel but for rounding, and gaps
// are equal along several axes. Nothing random finds these.
#include "narrowphase/collide.h"

#include "core/hard_pairs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rbs {
namespace {

using oracle::Random;

std::vector<std::pair<const char*, Shape>> shapesOfOneSize() {
  std::vector<Vec3> corners, prism;
  for (int k = 0; k < 8; ++k) corners.push_back(0.5 * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  for (int k = 0; k < 6; ++k)
    for (const double z : {-0.5, 0.5})
      prism.push_back({0.5 * std::cos(k * EIGEN_PI / 3), 0.5 * std::sin(k * EIGEN_PI / 3), z});
  return {{"box", Box{Vec3::Ones()}},         {"ball", Sphere{0.5}},    {"capsule", Capsule{0.25, 0.5}},
          {"cylinder", Cylinder{0.5, 1.0}},   {"cone", Cone{0.5, 1.0}}, {"cube", oracle::hullShape(corners)},
          {"prism", oracle::hullShape(prism)}};
}

// The deepest point says the gap, whatever tilts and shifts rounding makes, and every point is one.
TEST(AlignedManifolds, SayTheGap) {
  const auto shapes = shapesOfOneSize();
  Random random(61);
  for (const auto& [name_a, a] : shapes)
    for (const auto& [name_b, b] : shapes)
      for (int k = 0; k < 2000; ++k) {
        const double space = std::pow(10.0, random.uniform(-6.0, -2.0));
        const auto tilt = [&] {
          const double angle = k % 8 == 0 ? 0.0 : std::pow(10.0, random.uniform(-17.0, -3.0));
          return Quat(Eigen::AngleAxisd(angle, random.direction()));
        };
        const Vec3 way(static_cast<int>(random.below(3)) - 1, static_cast<int>(random.below(3)) - 1,
                       static_cast<int>(random.below(3)) - 1);
        if (way.isZero(0.0)) continue;
        const Pose X_WA{{0.0, 0.0, 0.0}, tilt()}, X_WB{(1.0 + space) * way, tilt()};
        const double distance = gap(a, X_WA, b, X_WB).distance, margin = 2.0 * space + 1e-3;
        const Manifold manifold = collide(a, X_WA, b, X_WB, margin);
        const std::string where = std::string(name_a) + " and " + name_b + ", pair " + std::to_string(k);
        if (distance < 0.99 * margin)
          ASSERT_GE(manifold.size, 1) << where;
        else if (distance > margin)
          continue;
        double deepest = margin;
        for (int p = 0; p < manifold.size; ++p) {
          const ManifoldPoint& point = manifold.points[p];
          ASSERT_TRUE(std::isfinite(point.separation) && point.p_W.allFinite()) << where;
          ASSERT_LT((point.p_W - 0.5 * X_WB.p_WB).norm(), 1.1) << where;
          deepest = std::min(deepest, point.separation);
        }
        ASSERT_NEAR(manifold.n_W.norm(), 1.0, 1e-12) << where;
        ASSERT_NEAR(deepest, std::min(distance, margin), 1e-5) << where << ", gap " << distance;
      }
}

}  // namespace
}  // namespace rbs

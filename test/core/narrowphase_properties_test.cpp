// SPDX-License-Identifier: BSD-3-Clause
// What holds for the gap of any two shapes, without knowing it: where they are and in which units does not
// matter, and moving one by d changes it by at most d, through touching too.
#include "core/hard_pairs.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace rbs {
namespace {

using oracle::Pair;
using oracle::Random;

struct Kind {
  const char *a, *b;
  double depth_tolerance;
  long pairs = 20000;  // fewer where more of them are known to fall short (docs/collision.md)

  friend void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.a << " and " << kind.b; }
};

double gapOf(const Pair& pair) {
  return gap(pair.a, pair.X_WA, pair.b, pair.X_WB).distance;
}

// In other units. A hull keeps its frame, wherever its centre of mass is.
Shape inUnits(const Shape& shape, double unit) {
  const auto* hull = std::get_if<ConvexHull>(&shape);
  if (hull == nullptr) return scaled(shape, unit);
  std::vector<Vec3> points = hull->polyhedron->vertices;
  for (Vec3& p : points) p *= unit;
  return oracle::hullShape(points);
}
// In units that are a power of two: every number keeps its digits.
Shape inBinaryUnits(const Shape& shape, double unit) {
  const auto* hull = std::get_if<ConvexHull>(&shape);
  if (hull == nullptr) return scaled(shape, unit);
  auto polyhedron = std::make_shared<Polyhedron>(*hull->polyhedron);
  for (Vec3& vertex : polyhedron->vertices) vertex *= unit;
  for (Polyhedron::Face& face : polyhedron->faces) face.offset *= unit;
  polyhedron->bounds = {unit * polyhedron->bounds.lo, unit * polyhedron->bounds.hi};
  polyhedron->bounding_radius *= unit;
  return ConvexHull{polyhedron};
}
Pose inUnits(const Pose& pose, double unit) {
  return {unit * pose.p_WB, pose.q_WB};
}

class Properties : public testing::TestWithParam<Kind> {
 protected:
  /// What one value may be off by, m.
  double allowed(const Pair& pair, double distance) const {
    const double size = oracle::sizeOf(pair);
    return distance > 1e-13 * size ? 1e-14 * size + 1e-12 * distance : GetParam().depth_tolerance * size;
  }
};

TEST_P(Properties, Hold) {
  const Kind kind = GetParam();
  const char* wanted = std::getenv("RBS_BATTERY_PAIRS");
  const long pairs = wanted != nullptr ? std::strtol(wanted, nullptr, 10) : kind.pairs;
  const std::uint64_t seed = 3;
  Random random(seed);
  int moved_wrong = 0, scaled_wrong = 0, rounded_wrong = 0, jumps = 0, judged_wrong = 0, kept_wrong = 0;
  for (long k = 0; k < pairs; ++k) {
    const Pair pair = randomPair(random, kind.a, kind.b);
    const Gap found = gap(pair.a, pair.X_WA, pair.b, pair.X_WB);
    const double size = oracle::sizeOf(pair), exact = 2.0 * allowed(pair, found.distance);
    const std::string where =
        "seed " + std::to_string(seed) + ", pair " + std::to_string(k) + "\n" + text(pair);

    // Far away the coordinates themselves are rounded.
    const double away = size * std::pow(10.0, random.uniform(0.0, 6.0));
    const Pose by{away * random.direction(), random.orientation()};
    const double moved = gapOf({pair.a, pair.b, oracle::moved(by, pair.X_WA), oracle::moved(by, pair.X_WB)});
    const double reach = away + size + std::abs(found.distance) + pair.X_WA.p_WB.norm();
    if (!(std::abs(moved - found.distance) <= exact + 1e-15 * reach) && ++moved_wrong == 1)
      ADD_FAILURE() << "moved: " << oracle::number(moved) << " for " << oracle::number(found.distance) << "\n"
                    << where;

    const double unit = std::pow(10.0, random.uniform(-6.0, 6.0));
    const double scaled_gap = gapOf({inUnits(pair.a, unit), inUnits(pair.b, unit), inUnits(pair.X_WA, unit),
                                     inUnits(pair.X_WB, unit)}) /
                              unit;
    const double coordinates = 1e-15 * (pair.X_WA.p_WB.norm() + pair.X_WB.p_WB.norm());
    if (!(std::abs(scaled_gap - found.distance) <= exact + coordinates) && ++scaled_wrong == 1)
      ADD_FAILURE() << "in units of " << unit << ": " << oracle::number(scaled_gap) << " for "
                    << oracle::number(found.distance) << "\n"
                    << where;

    for (const double power : {0x1p-8, 0x1p8}) {
      const Gap other = gap(inBinaryUnits(pair.a, power), inUnits(pair.X_WA, power),
                            inBinaryUnits(pair.b, power), inUnits(pair.X_WB, power));
      if ((other.distance != power * found.distance || other.n_W != found.n_W) && ++rounded_wrong == 1)
        ADD_FAILURE() << "in units of " << power << ": " << oracle::number(other.distance / power) << " for "
                      << oracle::number(found.distance) << ", normals apart by "
                      << (other.n_W - found.n_W).norm() << "\n"
                      << where;
    }

    for (const double margin : {0.0, found.distance * random.uniform(0.5, 1.5), 1e-3 * size}) {
      if (margin < 0.0 || std::abs(found.distance - margin) <= exact + 1e-13 * size) continue;
      const bool within = areWithin(pair.a, pair.X_WA, pair.b, pair.X_WB, margin);
      if (within != (found.distance < margin) && ++judged_wrong == 1)
        ADD_FAILURE() << (within ? "" : "not ") << "within " << oracle::number(margin) << " at a gap of "
                      << oracle::number(found.distance) << "\n"
                      << where;
    }

    Simplex kept;
    for (const double nudge : {0.0, 1e-9, 1e-3, 0.3}) {
      Pair nudged = pair;
      nudged.X_WB.p_WB += nudge * size * random.direction();
      nudged.X_WB.q_WB = oracle::turnedBy(nudge, random.direction()) * nudged.X_WB.q_WB;
      const double going_on = gap(nudged.a, nudged.X_WA, nudged.b, nudged.X_WB, kept).distance;
      const double afresh = gapOf(nudged);
      if (!(std::abs(going_on - afresh) <= 2.0 * allowed(pair, afresh) + coordinates) && ++kept_wrong == 1)
        ADD_FAILURE() << "from the last search " << oracle::number(going_on) << ", afresh "
                      << oracle::number(afresh) << " after a nudge of " << nudge << "\n"
                      << text(nudged);
    }

    if (std::abs(found.distance) > size) continue;
    double before = 0.0, place = 0.0;
    bool first = true;
    for (const double step : {-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6, 1e-3}) {
      Pair other = pair;
      other.X_WB.p_WB += (step * size - found.distance) * found.n_W;
      const double now = gapOf(other), here = step * size;
      const double slack = allowed(other, before) + allowed(other, now) + coordinates;
      if (!first && !(std::abs(now - before) <= here - place + slack) && ++jumps == 1)
        ADD_FAILURE() << "a step of " << here - place << " takes the gap from " << oracle::number(before)
                      << " to " << oracle::number(now) << "\n"
                      << text(other);
      first = false, before = now, place = here;
    }
  }
  EXPECT_EQ(moved_wrong, 0);
  EXPECT_EQ(scaled_wrong, 0);
  EXPECT_EQ(rounded_wrong, 0);
  EXPECT_EQ(jumps, 0);
  EXPECT_EQ(judged_wrong, 0);
  EXPECT_EQ(kept_wrong, 0);
}

std::string nameOf(const testing::TestParamInfo<Kind>& info) {
  return std::string(info.param.a) + "_" + info.param.b;
}

INSTANTIATE_TEST_SUITE_P(
    Narrowphase, Properties,
    testing::Values(
        Kind{"sphere", "sphere", 1e-12}, Kind{"sphere", "box", 1e-12}, Kind{"sphere", "hull", 1e-10},
        Kind{"sphere", "capsule", 1e-12}, Kind{"cylinder", "sphere", 1e-10}, Kind{"cone", "sphere", 1e-10},
        Kind{"box", "box", 1e-12, 10000}, Kind{"capsule", "box", 1e-12}, Kind{"cylinder", "box", 1e-10, 1000},
        Kind{"box", "cone", 1e-10, 2000}, Kind{"hull", "box", 1e-10}, Kind{"capsule", "capsule", 1e-12},
        Kind{"capsule", "cylinder", 1e-10, 5000}, Kind{"capsule", "cone", 1e-10},
        Kind{"capsule", "hull", 1e-10}, Kind{"cylinder", "cylinder", 1e-10, 5000},
        Kind{"cone", "cylinder", 1e-10, 5000}, Kind{"cylinder", "hull", 1e-10, 5000},
        Kind{"cone", "cone", 1e-10, 5000}, Kind{"cone", "hull", 1e-10, 5000}, Kind{"hull", "hull", 1e-10}),
    nameOf);

}  // namespace
}  // namespace rbs

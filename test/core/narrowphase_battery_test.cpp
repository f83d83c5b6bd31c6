// SPDX-License-Identifier: BSD-3-Clause
// Up to thirty thousand hard pairs of each kind against the oracles. A pair that fails is shrunk and
// printed as it can be pasted into narrowphase_regressions_test.cpp. RBS_BATTERY_PAIRS sets another number of
// pairs, RBS_BATTERY_SEED another seed.
#include "core/narrowphase_check.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

namespace rbs {
namespace {

using oracle::Pair;
using oracle::Random;
using oracle::Worst;

long fromEnvironment(const char* name, long otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::strtol(value, nullptr, 10) : otherwise;
}

/// Rounds of GJK and of EPA; none where the gap has a closed form.
struct Rounds {
  int gjk = 0, epa = 0;
};

template <class A, class B>
constexpr bool isClosed() {
  const bool sphere = std::is_same_v<A, Sphere> || std::is_same_v<B, Sphere>;
  const bool hull = std::is_same_v<A, ConvexHull> || std::is_same_v<B, ConvexHull>;
  return (sphere && !hull) || (std::is_same_v<A, Capsule> && std::is_same_v<B, Capsule>) ||
         std::is_same_v<A, Plane> || std::is_same_v<B, Plane>;
}

Rounds roundsOf(const Pair& pair) {
  return std::visit(
      [&](const auto& a, const auto& b) -> Rounds {
        if constexpr (isClosed<std::decay_t<decltype(a)>, std::decay_t<decltype(b)>>()) {
          return {};
        } else {
          const RelativePose X_AB(pair.X_WA, pair.X_WB);
          const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
          const Finish finish(coreOf(a), coreOf(b), X_AB);
          const GjkResult distance = gjk(difference, difference.centre(), finish);
          Rounds rounds{distance.iterations, 0};
          if (distance.overlap) {
            FinishFunction finish_function;
            if constexpr (finish.kRound) finish_function = finish;
            rounds.epa =
                epa(std::cref(difference), distance.simplex, distance.scale, finish_function).iterations;
          }
          return rounds;
        }
      },
      pair.a, pair.b);
}

struct Kind {
  const char *a, *b;
  double depth_tolerance;
  long pairs = 30000;
};

class Battery : public testing::TestWithParam<Kind> {};

TEST_P(Battery, AgreesWithTheOracle) {
  const Kind kind = GetParam();
  const long pairs = fromEnvironment("RBS_BATTERY_PAIRS", kind.pairs);
  const auto seed = static_cast<std::uint64_t>(fromEnvironment("RBS_BATTERY_SEED", 1));
  Random random(seed);
  Worst worst;
  std::map<std::string, int> faults;
  std::map<int, int> gjk_rounds, epa_rounds;
  for (long k = 0; k < pairs; ++k) {
    const Pair pair = randomPair(random, kind.a, kind.b);
    const std::string fault = faultOf(pair, kind.depth_tolerance, worst);
    const Rounds rounds = roundsOf(pair);
    ++gjk_rounds[rounds.gjk];
    if (rounds.epa > 0) ++epa_rounds[rounds.epa];
    if (fault.empty()) continue;
    const std::string what = fault.substr(0, fault.find(':'));
    if (++faults[what] > 1) continue;
    Worst unused;
    const auto same = [&](const Pair& other) {
      const std::string again = faultOf(other, kind.depth_tolerance, unused);
      return again.substr(0, again.find(':')) == what ? again : "";
    };
    const Pair small = oracle::shrunk(pair, same);
    ADD_FAILURE() << "seed " << seed << ", pair " << k << "\n"
                  << fault << "\nsmaller: " << same(small) << "\n"
                  << text(small);
  }
  std::string counts;
  for (const auto& [what, count] : faults) counts += " " + what + " " + std::to_string(count);
  EXPECT_EQ(counts, "");
  EXPECT_LT(gjk_rounds.rbegin()->first, kGjkIterations);
  if (!epa_rounds.empty()) {
    EXPECT_LT(epa_rounds.rbegin()->first, kEpaIterations);
  }
  std::printf(
      "%s-%s: apart %d, overlapping %d; distance %.1e depth %.1e normal %.1e along %.1e symmetry %.1e; "
      "normals undecided %d\n",
      kind.a, kind.b, worst.apart, worst.overlapping, worst.distance, worst.depth, worst.normal, worst.along,
      worst.symmetry, worst.undecided);
  for (const auto* rounds : {&gjk_rounds, &epa_rounds}) {
    std::printf("%s", rounds == &gjk_rounds ? "  GJK" : "  EPA");
    for (const auto& [number, count] : *rounds) std::printf(" %d:%d", number, count);
    std::printf("\n");
  }
}

// The oracle that enumerates and the one that certifies know nothing of each other.
TEST(Oracles, Agree) {
  const std::uint64_t seed = 2;
  Random random(seed);
  const char* polytopes[] = {"box", "hull", "capsule", "sphere"};
  const char* others[] = {"box", "hull", "capsule", "sphere", "cylinder", "cone"};
  int apart = 0;
  for (int k = 0; k < 20000; ++k) {
    const Pair pair = randomPair(random, polytopes[random.below(4)], others[random.below(6)]);
    const oracle::RoundedCore a = oracle::coreOfShape(pair.a), b = oracle::coreOfShape(pair.b);
    const oracle::Truth truth = judge(pair, Vec3::UnitX()).truth;
    const double size = oracle::sizeOf(pair);
    const oracle::Certified certified = std::visit(
        [&](const auto& core_a, const auto& core_b) {
          return certifiedDistance(placed(core_a, pair.X_WA, pair.X_WA.p_WB),
                                   placed(core_b, pair.X_WB, pair.X_WA.p_WB), oracle::Vec::UnitX());
        },
        a.core, b.core);
    const oracle::Real gap = truth.gap + a.radius + b.radius, rounding = 1e-16L * (size + std::abs(gap));
    const std::string where =
        "seed " + std::to_string(seed) + ", pair " + std::to_string(k) + "\n" + text(pair);
    ASSERT_LE(certified.lower, std::max(gap, oracle::Real(0)) + rounding) << where;
    if (gap > 0) {
      ++apart;
      ASSERT_GE(certified.upper, gap - rounding) << where;
    }
  }
  EXPECT_GT(apart, 5000);
}

std::string nameOf(const testing::TestParamInfo<Kind>& info) {
  return std::string(info.param.a) + "_" + info.param.b;
}

INSTANTIATE_TEST_SUITE_P(Narrowphase, Battery,
                         testing::Values(Kind{"sphere", "sphere", 1e-12}, Kind{"sphere", "box", 1e-12},
                                         Kind{"cylinder", "sphere", 1e-10}, Kind{"cone", "sphere", 1e-10},
                                         Kind{"box", "box", 1e-12}, Kind{"capsule", "capsule", 1e-12},
                                         Kind{"capsule", "box", 1e-12}),
                         nameOf);

// These take longer, or a hundred thousand pairs hold some that miss a figure: docs/collision.md says which.
INSTANTIATE_TEST_SUITE_P(
    Fewer, Battery,
    testing::Values(Kind{"hull", "box", 1e-10, 6000}, Kind{"capsule", "hull", 1e-10, 6000},
                    Kind{"hull", "hull", 1e-10, 3000}, Kind{"sphere", "hull", 1e-10, 6000},
                    Kind{"capsule", "cylinder", 1e-10, 6000}, Kind{"capsule", "cone", 1e-10, 15000},
                    Kind{"cylinder", "box", 1e-10, 3000}, Kind{"box", "cone", 1e-10, 2000},
                    Kind{"cone", "cylinder", 1e-10, 3000}, Kind{"cylinder", "cylinder", 1e-10, 3000},
                    Kind{"cone", "cone", 1e-10, 3000}, Kind{"cylinder", "hull", 1e-10, 2000},
                    Kind{"cone", "hull", 1e-10, 1000}),
    nameOf);

}  // namespace
}  // namespace rbs

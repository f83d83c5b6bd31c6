// A hundred thousand hard pairs of each kind against the oracles. A pair that fails is shrunk and printed as
// it can be pasted into narrowphase_regressions_test.cpp. RBS_BATTERY_PAIRS sets another number of pairs,
// RBS_BATTERY_SEED another seed.
#include "core/hard_pairs.h"
#include "narrowphase/collide.h"
#include "narrowphase/convex.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

namespace rbs {
namespace {

using oracle::Pair;
using oracle::Random;

long fromEnvironment(const char* name, long otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::strtol(value, nullptr, 10) : otherwise;
}

/// Rounds of GJK and of EPA.
struct Rounds {
  int gjk = 0, epa = 0;
};

Rounds roundsOf(const Pair& pair) {
  return std::visit(
      [&](const auto& a, const auto& b) -> Rounds {
        if constexpr (std::is_same_v<decltype(a), const Plane&> ||
                      std::is_same_v<decltype(b), const Plane&>) {
          return {};
        } else {
          const CoreDifference difference(coreOf(a), coreOf(b), RelativePose(pair.X_WA, pair.X_WB));
          const GjkResult distance = gjk(difference, difference.centre());
          Rounds rounds{distance.iterations, 0};
          if (distance.overlap)
            rounds.epa = epa(std::cref(difference), distance.simplex, distance.scale).iterations;
          return rounds;
        }
      },
      pair.a, pair.b);
}

/// The worst that was met, as fractions of the size.
struct Worst {
  double distance = 0, depth = 0, normal = 0, along = 0, symmetry = 0;
  int apart = 0, overlapping = 0;
};

/// What is wrong with a pair, or nothing.
std::string faultOf(const Pair& pair, double depth_tolerance, Worst& worst) {
  const double size = oracle::sizeOf(pair);
  const Gap found = gap(pair.a, pair.X_WA, pair.b, pair.X_WB);
  if (!std::isfinite(found.distance) || !found.n_W.allFinite()) return "not finite";
  if (std::abs(found.n_W.norm() - 1.0) > 1e-13)
    return "length: normal of " + oracle::number(found.n_W.norm());
  const oracle::Judged judged = judge(pair, found.n_W);
  const double truth = static_cast<double>(judged.truth.gap);
  const std::string values = oracle::number(found.distance) + ", truth " + oracle::number(truth) +
                             ", along its normal " + oracle::number(static_cast<double>(judged.along)) +
                             ", size " + oracle::number(size);

  if (std::abs(truth) > 1e-13 * size && (found.distance > 0.0) != (truth > 0.0)) return "class: " + values;
  const double error = found.distance > truth
                           ? found.distance - truth
                           : std::max(0.0, truth - found.distance - static_cast<double>(judged.slack));
  if (truth > 0.0) {
    ++worst.apart;
    const double beyond = error / (size + 100.0 * truth);
    worst.distance = std::max(worst.distance, beyond);
    if (beyond > 1e-14) return "distance: " + values;
  } else {
    ++worst.overlapping;
    worst.depth = std::max(worst.depth, error / size);
    if (error > depth_tolerance * size) return "depth: " + values;
  }
  // The normal is that of the cores. It must prove the gap, as far as the rounding of their nearest points
  // lets it, and be the true one where there is but one.
  const double core_gap = truth + static_cast<double>(judged.radius);
  const double along = std::abs(static_cast<double>(judged.along - judged.truth.gap));
  const double turned = 1e-15 * size / std::abs(core_gap);
  const double allowed =
      (truth > 0.0 ? 1e-12 * truth : 0.0) + depth_tolerance * size + turned * (size + core_gap);
  worst.along = std::max(worst.along, along / allowed);
  if (along > allowed) return "normal: the gap along it is off by " + oracle::number(along) + "; " + values;
  const bool unique =
      core_gap > 1e-6 * size ||
      (core_gap<-1e-6 * size&& static_cast<double>(judged.truth.runner_up) + truth> 1e-6 * size);
  if (unique) {
    const double angle = static_cast<double>((judged.truth.n - found.n_W.cast<oracle::Real>()).norm());
    worst.normal = std::max(worst.normal, angle);
    if (angle > 1e-9) return "normal: off by " + oracle::number(angle) + "; " + values;
  }
  // The points span the gap along the normal, and lie on the surfaces.
  const double span = (found.p_WB - found.p_WA - found.distance * found.n_W).norm();
  const double reach = size + std::abs(truth) + pair.X_WA.p_WB.norm();
  if (span > 1e-13 * reach)
    return "points: their difference is off the normal by " + oracle::number(span) + "; " + values;
  const Gap swapped = gap(pair.b, pair.X_WB, pair.a, pair.X_WA);
  const double asymmetry = std::abs(swapped.distance - found.distance) / (size + std::abs(truth));
  worst.symmetry = std::max(worst.symmetry, asymmetry);
  if (!(asymmetry <= 1e-14)) return "swapped: " + oracle::number(swapped.distance) + " for " + values;
  return "";
}

struct Kind {
  const char *a, *b;
  double depth_tolerance;
};

class Battery : public testing::TestWithParam<Kind> {};

TEST_P(Battery, AgreesWithTheOracle) {
  const Kind kind = GetParam();
  const long pairs = fromEnvironment("RBS_BATTERY_PAIRS", 100000);
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
      "%s-%s: apart %d, overlapping %d; distance %.1e depth %.1e normal %.1e along %.1e symmetry %.1e\n",
      kind.a, kind.b, worst.apart, worst.overlapping, worst.distance, worst.depth, worst.normal, worst.along,
      worst.symmetry);
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
                         testing::Values(Kind{"sphere", "sphere", 1e-12}, Kind{"sphere", "box", 1e-12}),
                         nameOf);

// To be enabled as they pass.
INSTANTIATE_TEST_SUITE_P(DISABLED_Narrowphase, Battery,
                         testing::Values(Kind{"box", "box", 1e-12}, Kind{"capsule", "capsule", 1e-12},
                                         Kind{"capsule", "box", 1e-12}, Kind{"capsule", "hull", 1e-10},
                                         Kind{"hull", "hull", 1e-10}, Kind{"hull", "box", 1e-10},
                                         Kind{"cylinder", "sphere", 1e-10}, Kind{"cylinder", "box", 1e-10},
                                         Kind{"cylinder", "cylinder", 1e-10}, Kind{"cone", "sphere", 1e-10},
                                         Kind{"cone", "hull", 1e-10}, Kind{"cone", "cylinder", 1e-10}),
                         nameOf);

}  // namespace
}  // namespace rbs

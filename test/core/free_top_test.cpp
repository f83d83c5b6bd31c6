// SPDX-License-Identifier: BSD-3-Clause
// The free top in closed form, against Euler's equations integrated in long double.
#include "dynamics/free_top.h"
#include "free_top_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::oracle;

namespace {

Inertia inertiaOf(const Vec3& moments) {
  Inertia inertia;
  inertia.inv_mass = 1.0;
  inertia.moments = moments;
  inertia.inv_moments = moments.cwiseInverse();
  inertia.isotropic = false;
  return inertia;
}

struct Case {
  std::string name;
  Vec3 moments, l;
};

// How far the answer is off, as a fraction of what a change of l by 1e-13 makes of the exact one if that is
// more than 1e-13: near the separatrix a free top forgets where it came from.
double fault(const Case& c, double t) {
  const FreeTurn turn = turnFreely(c.l, inertiaOf(c.moments), t);
  const TopState exact = integrated(c.l, c.moments, t);
  const TopState other = integrated(c.l + 1e-13 * c.l.norm() * Vec3(0.5, -0.7, 0.6), c.moments, t);
  const auto off = [&](const Quat& q, const Vec3& l) {
    return std::max(angleBetween(q, orientationOf(exact)),
                    (l - exact.tail<3>().cast<double>()).norm() / c.l.norm());
  };
  const double condition = std::max(1.0, off(orientationOf(other), other.tail<3>().cast<double>()) / 1e-13);
  return off(turn.q_B0B, turn.l_B) / condition;
}

double spread(std::mt19937_64& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

std::vector<Case> cases(std::mt19937_64& random) {
  const auto any = [&] { return Vec3(spread(random, -1, 1), spread(random, -1, 1), spread(random, -1, 1)); };
  const auto tiny = [&](double least) { return std::pow(10.0, spread(random, least, -1)); };
  std::array<int, 3> axis{0, 1, 2};
  std::shuffle(axis.begin(), axis.end(), random);
  const auto [small, middle, large] = axis;
  Vec3 I;
  I[small] = spread(random, 0.5, 0.9), I[middle] = spread(random, 0.9, 1.1),
  I[large] = spread(random, 1.1, 1.3);
  const auto with = [&](int i, double value) {
    Vec3 moments = I;
    moments[i] = value;
    return moments;
  };
  Vec3 on_separatrix = any();
  on_separatrix[small] = std::sqrt((1 / I[middle] - 1 / I[large]) / (1 / I[small] - 1 / I[middle])) *
                         std::abs(on_separatrix[large]) * (1.0 + tiny(-16));
  return {
      {"any", I, any()},
      {"nearly about the axis of the least moment", I, Vec3::Unit(small) + tiny(-17) * any()},
      {"nearly about the axis of the largest moment", I, -Vec3::Unit(large) + tiny(-17) * any()},
      {"nearly about the middle axis", I, Vec3::Unit(middle) + tiny(-13) * any()},
      {"about the middle axis", I, Vec3::Unit(middle)},
      {"near the separatrix", I, on_separatrix},
      {"needle", with(small, 2e-4 * I[middle]), any()},
      {"disc", with(large, 0.99999 * (I[small] + I[middle])), any()},
      {"two moments nearly equal, the larger", with(large, I[middle] * (1.0 + tiny(-15))), any()},
      {"two moments nearly equal, the smaller", with(small, I[middle] * (1.0 - tiny(-15))), any()},
      {"two moments equal", with(small, I[middle]), any()},
      {"three moments nearly equal", Vec3::Ones() + tiny(-15) * any(), any()},
  };
}

TEST(FreeTop, FollowsEulersEquationsToRounding) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    for (const Case& c : cases(random)) {
      const double turn = std::pow(10.0, spread(random, -4.0, 1.5));
      EXPECT_LE(fault(c, turn / fastest(c.l, c.moments)), 2e-14 * std::max(1.0, turn / 10.0))
          << c.name << ", turn " << turn << ", round " << round;
    }
  }
}

// With moments 1e9 apart the fast turn is about 1e9 times the slow one.
TEST(FreeTop, HoldsForMomentsAThousandMillionTimesApart) {
  for (const Vec3& moments : {Vec3(1e-9, 1.0, 1.1), Vec3(1.0, 1e-9, 1.0), Vec3(1e9, 1.0, 1e9)}) {
    Vec3 l(0.3, 0.4, -0.5);
    EXPECT_LE(fault({"", moments, l}, 1e3 / fastest(l, moments)), 1e-13) << moments.transpose();
    l[0] *= 1e-9, l[1] *= 1e-9;
    EXPECT_LE(fault({"", moments, l}, 1e3 / fastest(l, moments)), 1e-13) << moments.transpose();
  }
}

// Two halves make a whole, and nothing grows with the number of turns but the rounding of their angle.
TEST(FreeTop, TurnsAsFarAsOneLikes) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 40; ++round) {
    const double turn = std::pow(10.0, 2 + round % 8);
    for (const Case& c : cases(random)) {
      if (c.name.find("middle") != std::string::npos || c.name == "near the separatrix") continue;
      const Inertia inertia = inertiaOf(c.moments);
      const double t = turn / fastest(c.l, c.moments);
      const FreeTurn whole = turnFreely(c.l, inertia, t), half = turnFreely(c.l, inertia, 0.5 * t),
                     other = turnFreely(half.l_B, inertia, 0.5 * t);
      EXPECT_LE((whole.l_B - other.l_B).norm(), 2e-15 * turn * c.l.norm()) << c.name << ", turn " << turn;
      EXPECT_LE(angleBetween(whole.q_B0B, half.q_B0B * other.q_B0B), 5e-15 * turn)
          << c.name << ", turn " << turn;
      EXPECT_LE((whole.q_B0B * whole.l_B - c.l).norm(), 1e-14 * c.l.norm()) << c.name << ", turn " << turn;
    }
  }
}

// However fast, and on the separatrix itself, where the period is infinite: never a number that is none.
TEST(FreeTop, IsFiniteHoweverFastTheSpin) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round)
    for (const Case& c : cases(random))
      for (const double rate : {1e-150, 1e-20, 1e12, 1e100}) {
        const FreeTurn turn = turnFreely(rate * c.l, inertiaOf(c.moments), 1.0);
        EXPECT_TRUE(turn.q_B0B.coeffs().allFinite() && turn.l_B.allFinite()) << c.name << ", rate " << rate;
        EXPECT_NEAR(turn.l_B.norm() / (rate * c.l.norm()), 1.0, 1e-14) << c.name << ", rate " << rate;
      }
}

// At no time does a top turn faster than its bound, nor does its angular velocity change faster. The bounds
// are not idle: what they are made of is reached within a few turns, but near the separatrix, where that may
// take for ever.
TEST(FreeTop, KeepsTheBoundsOfItsSpin) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 20; ++round)
    for (const Case& c : cases(random)) {
      const Inertia inertia = inertiaOf(c.moments);
      const SpinBounds bounds = spinBoundsOf(c.l.cwiseQuotient(c.moments), inertia);
      double spin = 0.0, change = 0.0;
      for (int k = 0; k <= 2000; ++k) {
        const double t = 0.02 * k / fastest(c.l, c.moments);
        const Vec3 l = k == 0 ? c.l : turnFreely(c.l, inertia, t).l_B, w = l.cwiseQuotient(c.moments);
        spin = std::max(spin, w.norm());
        change = std::max(change, Vec3(l.cross(w).cwiseQuotient(c.moments)).norm());
      }
      EXPECT_LE(spin, bounds.w * (1.0 + 1e-13)) << c.name << ", round " << round;
      EXPECT_LE(change, bounds.change * (1.0 + 1e-13) + 1e-13 * spin * spin) << c.name << ", round " << round;
      if (c.name == "any") {
        EXPECT_GE(spin, bounds.w / std::sqrt(3.0)) << "round " << round;
      }
    }
}

}  // namespace

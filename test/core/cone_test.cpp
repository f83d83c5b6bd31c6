// SPDX-License-Identifier: BSD-3-Clause
// The contact on Coulomb's cone against what defines it.
#include "coulomb/cone.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;

namespace {

enum class Found { Parted, Stuck, Slid };

// Signorini, Coulomb and maximum dissipation: u_n >= 0, r_n >= 0, u_n r_n = 0; |r_T| <= mu r_n; and a contact
// that slides has r_T against u_T, on the cone.
Found expectLaw(const Mat3& W, const Vec3& q, double mu, int trial) {
  const Vec3 r = solveContact(W, q, mu);
  const Vec3 u = W * r + q;
  EXPECT_TRUE(r.allFinite()) << trial;
  const double scale = q.norm();
  if (r[2] == 0.0) {
    EXPECT_GE(u[2], -1e-12 * scale) << trial;
    EXPECT_EQ(r.norm(), 0.0) << trial;
    return Found::Parted;
  }
  EXPECT_GT(r[2], 0.0) << trial;
  EXPECT_NEAR(u[2], 0.0, 1e-9 * scale) << trial;
  const double limit = mu * r[2];
  EXPECT_LE(r.head<2>().norm(), limit * (1.0 + 1e-12)) << trial;
  if (u.head<2>().norm() <= 1e-9 * scale) return Found::Stuck;
  EXPECT_NEAR(r.head<2>().norm(), limit, 1e-12 * (limit + r[2])) << trial;
  EXPECT_NEAR(u.head<2>().dot(r.head<2>()), -u.head<2>().norm() * r.head<2>().norm(), 1e-9 * scale * r.norm())
      << trial;
  return Found::Slid;
}

Mat3 randomMatrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Mat3 A;
  for (double& a : A.reshaped()) a = normal(random);
  return A * A.transpose() + 0.05 * Mat3::Identity();
}

TEST(Cone, AnImpulseKeepsTheLawsOfContact) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int found[3] = {};
  for (int trial = 0; trial < 20000; ++trial) {
    const Mat3 W = randomMatrix(random);
    const Vec3 q(normal(random), normal(random), normal(random));
    ++found[static_cast<int>(expectLaw(W, q, trial % 5 == 0 ? 0.0 : std::abs(normal(random)), trial))];
  }
  for (const int times : found) EXPECT_GT(times, 1000);
}

// What sticks by all of its friction is found so, whichever way its impulse is rounded.
TEST(Cone, AnImpulseOnTheConeKeepsThem) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20000; ++trial) {
    const Mat3 W = randomMatrix(random);
    const double mu = 0.05 + std::abs(normal(random));
    Vec3 r(normal(random), normal(random), 0.0);
    r[2] = r.head<2>().norm() / mu;
    expectLaw(W, -(W * r), mu, trial);
  }
}

}  // namespace

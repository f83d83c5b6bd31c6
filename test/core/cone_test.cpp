// SPDX-License-Identifier: BSD-3-Clause
// The contact on Coulomb's cone against what defines it.
#include "coulomb/cone.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;

namespace {

// Signorini, Coulomb and maximum dissipation: u_n >= 0, r_n >= 0, u_n r_n = 0; |r_T| <= mu r_n; and a contact
// that slides has r_T against u_T, on the cone.
TEST(Cone, AnImpulseKeepsTheLawsOfContact) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int stuck = 0, slid = 0, parted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Mat3 A;
    for (double& a : A.reshaped()) a = normal(random);
    const Mat3 W = A * A.transpose() + 0.05 * Mat3::Identity();
    const Vec3 q(normal(random), normal(random), normal(random));
    const double mu = trial % 5 == 0 ? 0.0 : std::abs(normal(random));
    const Vec3 r = solveContact(W, q, mu);
    const Vec3 u = W * r + q;
    ASSERT_TRUE(r.allFinite());
    const double scale = q.norm();
    if (r[2] == 0.0) {
      ++parted;
      EXPECT_GE(u[2], -1e-12 * scale);
      EXPECT_EQ(r.norm(), 0.0);
      continue;
    }
    EXPECT_GT(r[2], 0.0);
    EXPECT_NEAR(u[2], 0.0, 1e-9 * scale) << trial;
    const double limit = mu * r[2];
    EXPECT_LE(r.head<2>().norm(), limit * (1.0 + 1e-12));
    if (u.head<2>().norm() <= 1e-9 * scale) {
      ++stuck;
      continue;
    }
    ++slid;
    EXPECT_NEAR(r.head<2>().norm(), limit, 1e-12 * (limit + r[2]));
    EXPECT_NEAR(u.head<2>().dot(r.head<2>()), -u.head<2>().norm() * r.head<2>().norm(),
                1e-9 * scale * r.norm())
        << trial;
  }
  EXPECT_GT(stuck, 1000);
  EXPECT_GT(slid, 1000);
  EXPECT_GT(parted, 1000);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/friction_set.h"

#include <algorithm>

namespace rbs::coulomb {

Vec3 nearestOnCone(const FrictionSet<2>& sliding, const Vec3& x) {
  const double mu = sliding.factor;
  if (sliding.slips) {
    const double n = std::max(x[2], 0.0);
    return {-mu * n * sliding.slip[0], -mu * n * sliding.slip[1], n};
  }
  const double length = x.head<2>().norm();
  if (length <= mu * x[2]) return x;
  const double n = (mu * length + x[2]) / (1.0 + mu * mu);
  if (n <= 0.0) return Vec3::Zero();
  if (mu == 0.0) return {0.0, 0.0, n};
  return {mu * n / length * x[0], mu * n / length * x[1], n};
}

}  // namespace rbs::coulomb

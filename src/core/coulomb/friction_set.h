// SPDX-License-Identifier: BSD-3-Clause
// The admissible sets of friction: what the impulses of sliding, rolling and spinning may be.
//
// n rows (two of sliding or rolling, one of spinning) under the normal impulse N have their impulse x in the
// ball |x| <= factor N. Where the direction of slip is prescribed, x is -factor N slip. A contact point under
// its own normal impulse makes Coulomb's cone with it.
//
// A solver asks a set for the nearest impulse, for the step of an augmented Lagrangian with its derivatives,
// and for the barrier of an interior point (friction_barrier.h).
#pragma once

#include "rigid_body_sim/types.h"

#include <cmath>

namespace rbs::coulomb {

template <int n>
struct FrictionSet {
  using Vec = Eigen::Matrix<double, n, 1>;
  using Mat = Eigen::Matrix<double, n, n>;

  double factor = 0.0;     ///< >= 0
  bool slips = false;      ///< the direction of slip is prescribed
  Vec slip = Vec::Zero();  ///< that direction, of length 1 where it is

  FrictionSet() = default;
  /// @param slip zero: the law decides
  FrictionSet(double factor, const Vec& slip)
      : factor(factor), slips(factor > 0.0 && !slip.isZero(0.0)), slip(slip) {}

  /// False: N alone determines the impulse, by the prescribed slip or because the factor is 0.
  bool isBall() const { return factor > 0.0 && !slips; }

  /// The impulse of the set that is nearest to x.
  Vec nearest(const Vec& x, double N) const {
    const double limit = factor * N;
    if (slips) return -limit * slip;
    const double length = x.norm();
    return length > limit ? Vec(limit / length * x) : x;
  }

  /// d = nearest(r - rho u, N) - r, and how it changes: by -by_u du and by factor by_N dN.
  struct Step {
    Vec d;
    Mat by_u;
    Vec by_N;
  };
  Step step(const Vec& r, const Vec& u, double rho, double N) const {
    Step step;
    const double limit = factor * N;
    if (slips) {
      step.d = -limit * slip - r;
      step.by_u.setZero();
      step.by_N = -slip;
      return step;
    }
    const Vec x = r - rho * u;
    const double length = x.norm();
    if (length <= limit) {
      step.d = -rho * u;
      step.by_u = rho * Mat::Identity();
      step.by_N.setZero();
    } else {
      const Vec t = x / length;
      step.d = limit * t - r;
      step.by_u = rho * limit / length * (Mat::Identity() - t * t.transpose());
      step.by_N = t;
    }
    return step;
  }
};

/// The nearest impulse of a contact point in its cone, |r_T| <= mu r_n; on its ray where slip is prescribed.
Vec3 nearestOnCone(const FrictionSet<2>& sliding, const Vec3& x);

}  // namespace rbs::coulomb

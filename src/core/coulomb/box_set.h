// SPDX-License-Identifier: BSD-3-Clause
// The admissible set of the rows of joints, limits and motors: each impulse lies between bounds of its own.
//
// With lo <= hi, one or both of them infinite, and u the velocity of a row, the law is
//   u = 0 where lo < r < hi,   u >= 0 where r = lo,   u <= 0 where r = hi:
// a mixed linear complementarity problem (Cottle, Pang and Stone 1992, section 1.5). Without bounds a row is bilateral; equal
// bounds prescribe its impulse, and u is free.
//
// A solver asks the set for the nearest impulse, for the step of an augmented Lagrangian with its derivatives, and for the
// barrier of an interior point (box_barrier.h).
#pragma once

#include "rigid_body_sim/types.h"

namespace rbs::coulomb {

struct BoxSet {
  Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();

  /// The impulses of the set that are nearest to x.
  Vec3 nearest(const Vec3& x) const { return x.cwiseMax(lo).cwiseMin(hi); }

  /// d = nearest(r - rho u) - r, and how it changes: row by row by -by_u du.
  struct Step {
    Vec3 d, by_u;
  };
  Step step(const Vec3& r, const Vec3& u, double rho) const {
    Step step;
    for (int c = 0; c < 3; ++c) {
      const double x = r[c] - rho * u[c];
      const bool is_within = lo[c] < x && x < hi[c];
      step.d[c] = is_within ? -rho * u[c] : (x <= lo[c] ? lo[c] : hi[c]) - r[c];
      step.by_u[c] = is_within ? rho : 0.0;
    }
    return step;
  }
};

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/separating_axis.h"

#include "narrowphase/tolerances.h"

namespace rbs {

double separationAlong(const Vec3& n_W, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return n_W.dot(X_WB.p_WB - X_WA.p_WB) - reach(a, X_WA.q_WB.conjugate() * n_W) -
         reach(b, X_WB.q_WB.conjugate() * -n_W);
}

bool SeparatingAxis::separates(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                               double margin) {
  ++queries;
  if (n_A.isZero(0.0)) return false;
  const double rounding = kChainRounding * (X_WA.p_WB.lpNorm<1>() + X_WB.p_WB.lpNorm<1>() + margin);
  if (!(separationAlong(X_WA.q_WB * n_A, a, X_WA, b, X_WB) > margin + rounding)) return false;
  ++kept;
  return true;
}

}  // namespace rbs

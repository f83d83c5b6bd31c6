// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/same_side.h"

#include "narrowphase/collide.h"
#include "narrowphase/separating_axis.h"
#include "narrowphase/time_of_impact.h"

namespace rbs {

Manifold manifoldOnSide(const Vec3& n_W, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        double margin) {
  Motion stays, comes;
  stays.pose = X_WA;
  const double clear = -separationAlong(n_W, a, X_WA, b, X_WB);
  comes.pose = X_WB;
  comes.pose.p_WB += clear * n_W;
  comes.twist.v_WB = -clear * n_W;
  const double met = timeOfImpact(a, stays, b, comes, 0.0, 1.0).value_or(1.0);
  const double depth = (1.0 - met) * clear;
  Manifold manifold = collide(a, X_WA, b, comes.at(met), margin);
  for (int k = 0; k < manifold.size; ++k) {
    ManifoldPoint& point = manifold.points[k];
    point.p_W -= 0.5 * depth * n_W;
    point.separation -= depth * n_W.dot(manifold.n_W);
  }
  return manifold;
}

}  // namespace rbs

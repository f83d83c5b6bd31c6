// SPDX-License-Identifier: BSD-3-Clause
#include "step/paths.h"

#include "base/algebra.h"
#include "narrowphase/collide.h"
#include "narrowphase/time_of_impact.h"

namespace rbs {

std::optional<PathImpact> impactOnPaths(const Shape& a, const Motion& path_a, const Shape& b,
                                        const Motion& path_b, double from, double to) {
  const std::optional<double> time = timeOfImpact(a, path_a, b, path_b, from, to);
  if (!time) return {};
  const Pose X_a = path_a.at(*time), X_b = path_b.at(*time);
  const Gap met = gap(a, X_a, b, X_b);
  const double closing = met.n_W.dot(velocityAt(path_a.twistAt(*time), met.p_WA - X_a.p_WB) -
                                     velocityAt(path_b.twistAt(*time), met.p_WB - X_b.p_WB));
  return PathImpact{*time, closing * (to - *time)};
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "step/ways.h"

#include "base/algebra.h"
#include "narrowphase/collide.h"
#include "narrowphase/time_of_impact.h"

namespace rbs {

std::optional<MetOnWay> metOnWay(const Shape& a, const Motion& way_a, const Shape& b, const Motion& way_b,
                                 double from, double to) {
  const std::optional<double> time = timeOfImpact(a, way_a, b, way_b, from, to);
  if (!time) return {};
  const Pose X_a = way_a.at(*time), X_b = way_b.at(*time);
  const Gap met = gap(a, X_a, b, X_b);
  const double closing = met.n_W.dot(velocityAt(way_a.twistAt(*time), met.p_WA - X_a.p_WB) -
                                     velocityAt(way_b.twistAt(*time), met.p_WB - X_b.p_WB));
  return MetOnWay{*time, closing * (to - *time)};
}

}  // namespace rbs

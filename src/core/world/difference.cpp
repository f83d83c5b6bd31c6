// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/difference.h"

#include <cmath>

namespace rbs {

Difference differenceOf(const Snapshot& run, const Snapshot& truth) {
  Difference result;
  double scale = truth.totals.kinetic_energy;
  for (std::size_t k = 0; k < truth.states.size(); ++k) {
    const BodyDescription& body = (*truth.bodies)[k];
    if (body.kind != BodyKind::Dynamic) continue;
    const Pose &a = run.states[k].pose, &b = truth.states[k].pose;
    const double distance = (a.p_WB - b.p_WB).norm(), angle = a.q_WB.angularDistance(b.q_WB);
    if (distance > result.distance) result.distance = distance, result.moved_body = body.name;
    if (angle > result.angle) result.angle = angle, result.turned_body = body.name;
    scale += body.mass * truth.gravity.norm() * boundingRadius(body.shape);
  }
  const auto energyOf = [](const Totals& totals) { return totals.kinetic_energy + totals.potential_energy; };
  if (scale > 0.0) result.energy = std::abs(energyOf(run.totals) - energyOf(truth.totals)) / scale;
  return result;
}

}  // namespace rbs

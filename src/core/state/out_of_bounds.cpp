// SPDX-License-Identifier: BSD-3-Clause
#include "state/out_of_bounds.h"

namespace rbs {

bool withinLimits(const Pose& pose, const Twist& twist) {
  const auto within = [](const Vec3& v, double limit) {
    return v.allFinite() && v.cwiseAbs().maxCoeff() <= limit;
  };
  return within(pose.p_WB, Limits::max_position) && pose.q_WB.coeffs().allFinite() &&
         within(twist.v_WB, Limits::max_speed) && within(twist.w_WB, Limits::max_spin);
}

void freeze(Context& context, Index i, const Pose& before, const Twist& twist_before) {
  Bodies& bodies = context.scene.bodies;
  bodies.pose[i] = before;
  bodies.twist[i] = twist_before;
  bodies.updateOrientation(i, context.step.t0);
  bodies.twist[i] = {};
  bodies.traits[i].frozen = true;
  bodies.refresh(i);
  context.step.report.warnings.push_back(
      {"non_finite", "body '" + bodies.name[i] +
                         "' is out of bounds or non-finite, and is frozen at its last position; delete it, "
                         "or make it dynamic "
                         "again with less speed, or shorten the step"});
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "state/out_of_bounds.h"

#include "base/text.h"

namespace rbs {

bool withinLimits(const Pose& pose, const Twist& twist) {
  const auto within = [](const Vec3& v, double limit) { return v.norm() <= limit; };
  return within(pose.p_WB, Limits::max_position) && pose.q_WB.coeffs().allFinite() &&
         within(twist.v_WB, Limits::max_speed) && within(twist.w_WB, Limits::max_spin);
}

namespace {

// A hair below the limits, so that rounding does not lead beyond them.
constexpr double kBelowLimit = 1.0 - 1e-12;

void slowDown(Context& context, Index i) {
  Bodies& bodies = context.scene.bodies;
  Twist slower = bodies.twist[i];
  const double v = slower.v_WB.norm(), w = slower.w_WB.norm();
  if (v > Limits::max_speed) slower.v_WB *= kBelowLimit * Limits::max_speed / v;
  if (w > Limits::max_spin) slower.w_WB *= kBelowLimit * Limits::max_spin / w;
  bodies.updateOrientation(i, context.step.t1);
  bodies.twist[i] = slower;
  context.step.report.warnings.push_back(
      {"too_fast", "body '" + bodies.name[i] + "' got faster than " + text(Limits::max_speed) + " m/s or " +
                       text(Limits::max_spin) + " rad/s, and is slowed down to that; shorten the step, or " +
                       "let less act on it"});
}

}  // namespace

void bringBack(Context& context, Index i, const Pose& before, const Twist& twist_before) {
  Bodies& bodies = context.scene.bodies;
  if (withinLimits(bodies.pose[i], {}) && bodies.twist[i].v_WB.allFinite() &&
      bodies.twist[i].w_WB.allFinite())
    return slowDown(context, i);
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

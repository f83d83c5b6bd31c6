// SPDX-License-Identifier: BSD-3-Clause
#include "base/algebra.h"
#include "base/text.h"
#include "effects/effects.h"

#include <algorithm>

namespace rbs::wrenches {

Need need(const SceneAnalysis& c) {
  if (c.wrenches == 0) return {false, "no wrench is applied"};
  return {true, count(c.wrenches, "wrench is", "wrenches are") + " applied"};
}

// A wrench that ends inside the step acts for its share of it: its impulse is exact. The point of the force
// moves with the body, T = T_0 + (R p) x F with R as it will be in the middle of the step: of second order.
void run(Context& context) {
  StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  for (const TimedWrench& wrench : context.scene.wrenches) {
    const Index i = bodies.indexOf(wrench.body);
    if (i == kNone || !bodies.traits[i].moved_by_forces()) continue;
    const double share = std::clamp((wrench.until - step.t0) / step.h(), 0.0, 1.0);
    step.load[i].a_W += share * bodies.inertia[i].inv_mass * wrench.force_W;
    const Quat half_turn = rotationBy(0.5 * step.h() * bodies.twist[i].w_WB);
    const Vec3 arm_W = half_turn * (bodies.pose[i].q_WB * wrench.point_B);
    step.load[i].torque_W += share * (wrench.torque_W + arm_W.cross(wrench.force_W));
  }
}

}  // namespace rbs::wrenches

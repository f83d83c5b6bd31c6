// SPDX-License-Identifier: BSD-3-Clause
#include "effects/effects.h"
#include "text.h"

#include <algorithm>

namespace rbs::wrenches {

Need need(const Census& c) {
  if (c.wrenches == 0) return {false, "no wrench is applied"};
  return {true, count(c.wrenches, "wrench is", "wrenches are") + " applied"};
}

// A wrench that ends inside the step acts for its share of it: its impulse is exact.
void run(Context& context) {
  StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  for (const TimedWrench& wrench : context.scene.wrenches) {
    const Index i = bodies.indexOf(wrench.body);
    if (i == kNone) continue;
    const double share = std::clamp((wrench.until - step.t0) / step.h(), 0.0, 1.0);
    step.load[i].a_W += share * bodies.inertia[i].inv_mass * wrench.force_W;
    step.load[i].torque_W += share * wrench.torque_W;
  }
}

}  // namespace rbs::wrenches

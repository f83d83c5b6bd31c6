// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "effects/effects.h"

namespace rbs::gravity {

Need need(const SceneAnalysis& c) {
  if (c.scene.gravity.norm() == 0.0) return {false, "the scene has no gravity"};
  if (c.moved_by_forces == 0) return {false, "no body is moved by forces"};
  return {true, text(c.scene.gravity.norm()) + " m/s^2 on " + count(c.moved_by_forces, "body", "bodies")};
}

// Ballistic bodies feel it in their flight.
void run(Context& context) {
  for (const Index i : context.scene.lists.in_islands) context.step.load[i].a_W += context.scene.gravity_W;
}

}  // namespace rbs::gravity

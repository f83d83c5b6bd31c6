// SPDX-License-Identifier: BSD-3-Clause
// Flight: bodies that nothing touches, over any length of time: in closed form, or to rounding where the air
// slows them.
#include "effects/effects.h"
#include "effects_built.h"
#include "integrate.h"
#include "methods/methods.h"

namespace rbs::flight {

void advance(Context& context, const IslandBatch& batch, double t0, double t1) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : batch.bodies) {
    const Load& load = context.step.load[i];
    std::optional<Course> course;
    if constexpr (built::drag)
      course = drag::fly(context, i, bodies.pose[i].p_WB, bodies.twist[i].v_WB, t1 - t0);
    fly(bodies.pose[i], bodies.twist[i], bodies.inertia[i], load.a_W, load.torque_W, t1 - t0);
    if (course) bodies.pose[i].p_WB = course->p_WB, bodies.twist[i].v_WB = course->v_WB;
  }
}

}  // namespace rbs::flight

// Flight: bodies that nothing touches, over any length of time in closed form.
#include "integrate.h"
#include "methods/methods.h"

namespace rbs::flight {

void advance(Context& context, const IslandBatch& batch, double t0, double t1) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : batch.bodies) {
    const Load& load = context.step.load[i];
    fly(bodies.pose[i], bodies.twist[i], bodies.inertia[i], load.a_W, load.torque_W, t1 - t0);
  }
}

}  // namespace rbs::flight

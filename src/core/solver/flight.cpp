// SPDX-License-Identifier: BSD-3-Clause
// Flight: bodies that nothing touches, over any length of time: in closed form, or to rounding where the air
// slows them.
#include "dynamics/integrate.h"
#include "effects/effects.h"
#include "effects_built.h"
#include "solver/inner_step.h"
#include "solver/methods.h"

#include <utility>

namespace rbs::flight {

namespace {

class Flight : public InnerRows {
 public:
  Flight(Context& context, const Subgraph& batch, double seconds)
      : context_(context), batch_(batch), seconds_(seconds) {}

  bool beginSubStep() { return !std::exchange(begun_, true); }
  void integrate() {
    Bodies& bodies = context_.scene.bodies;
    [[maybe_unused]] const bool in_air = !context_.step.load_without_drag.empty();
    for (const Index i : batch_.bodies) {
      const Load& load = context_.step.load[i];
      std::optional<FlightEnd> end;
      if constexpr (built::drag)
        if (in_air) end = drag::fly(context_, i, bodies.pose[i].p_WB, bodies.twist[i].v_WB, seconds_);
      fly(bodies.pose[i], bodies.twist[i], bodies.inertia[i], load.a_W, load.torque_W, seconds_);
      if (end) bodies.pose[i].p_WB = end->p_WB, bodies.twist[i].v_WB = end->v_WB;
    }
  }

 private:
  Context& context_;
  const Subgraph& batch_;
  double seconds_;
  bool begun_ = false;
};

}  // namespace

void advance(Context& context, const Subgraph& batch, double t0, double t1) {
  InnerClock clock(context.step.row_seconds);
  Flight method(context, batch, t1 - t0);
  runInnerStep(method, clock);
}

}  // namespace rbs::flight

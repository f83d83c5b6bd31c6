#include "certificate.h"

#include <algorithm>
#include <cmath>

namespace rbs::certificate {

namespace {

// Within the limits of what an edit may ask for: beyond them a body is lost, and a saved state could not be
// read.
bool sound(const Pose& pose, const Twist& twist) {
  const auto within = [](const Vec3& v, double limit) {
    return v.allFinite() && v.cwiseAbs().maxCoeff() <= limit;
  };
  return within(pose.p_WB, Limits::max_position) && pose.q_WB.coeffs().allFinite() &&
         within(twist.v_WB, Limits::max_speed) && within(twist.w_WB, Limits::max_spin);
}

void freeze(Context& context, Index i) {
  Bodies& bodies = context.scene.bodies;
  bodies.pose[i] = context.step.before[i];
  bodies.twist[i] = {};
  bodies.traits[i].frozen = true;
  bodies.refresh(i);
  context.step.report.warnings.push_back(
      {"non_finite",
       "body '" + bodies.name[i] +
           "' left all bounds and is frozen where it last was; delete it, or make it dynamic again "
           "with less speed, or shorten the step"});
}

}  // namespace

Need need(const Census& c) {
  if (c.moved_by_forces == 0 && c.led == 0) return {false, "nothing moves"};
  return {true, "every step is checked"};
}

void run(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  for (const std::vector<Index>* roster : {&context.scene.rosters.movers, &context.scene.rosters.led})
    for (const Index i : *roster)
      if (!sound(bodies.pose[i], bodies.twist[i])) freeze(context, i);

  StepStore& step = context.step;
  for (const ContactPair& pair : step.contacts.pairs) {
    if (pair.first < step.inherited) continue;
    step.report.contacts += pair.size;
    for (Index t = pair.first; t < pair.first + pair.size; ++t)
      step.report.deepest_penetration =
          std::max(step.report.deepest_penetration, -step.contacts.touches[t].separation);
  }
}

}  // namespace rbs::certificate

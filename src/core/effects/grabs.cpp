// SPDX-License-Identifier: BSD-3-Clause
#include "algebra.h"
#include "effects/effects.h"
#include "text.h"

#include <cmath>

namespace rbs::grabs {

Need need(const Census& c) {
  if (c.grabs == 0) return {false, "no hand holds a body"};
  return {true, count(c.grabs, "hand pulls", "hands pull") + " at a body"};
}

// A spring and damper between a point of the body and the hand, taken implicitly over the step h so that any
// stiffness is stable. With C the offset of the point from the hand, u its velocity at the end of the step
// were there no hand, K the response of the point to an impulse there,
//   K = 1/m - [r] I^-1 [r],
// and w = 2 pi f, critical damping (ratio 1), implicit Euler of  C'' = -w² C - 2 w C'  gives the impulse
//   P = -K^-1 s (u + b C),   b = w/(2 + h w),   s = h w (2 + h w)/(1 + h w (2 + h w))
// (the soft constraint of Catto, "Soft constraints", GDC 2011). |P| is capped at m a_max h, so a hand can
// neither lift the immovable nor shoot a body away.
void run(Context& context) {
  StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  const double h = step.h();
  for (const HandGrab& hand : context.scene.grabs) {
    const Index i = bodies.indexOf(hand.body);
    if (i == kNone || !bodies.traits[i].moved_by_forces()) continue;
    const Mat3 R_WB = bodies.R_WB(i);
    const Vec3 r_W = R_WB * hand.grab.p_B;
    const Mat3 inv_inertia_W = bodies.inertia[i].inverseW(R_WB);
    const Mat3 lever = crossMatrix(r_W);
    const Mat3 K = bodies.inertia[i].inv_mass * Mat3::Identity() - lever * inv_inertia_W * lever;

    const Vec3 offset = bodies.pose[i].p_WB + r_W - hand.grab.p_W;
    const Vec3 v = bodies.twist[i].v_WB + h * step.load[i].a_W;
    const Vec3 w = bodies.twist[i].w_WB + h * (inv_inertia_W * step.load[i].torque_W);
    const double omega = 2.0 * kPi * hand.grab.frequency;
    const double bias = omega / (2.0 + h * omega);
    const double stiff = h * omega * (2.0 + h * omega);
    Vec3 impulse = -stiff / (1.0 + stiff) * (K.inverse() * (v + w.cross(r_W) + bias * offset));

    const double cap = hand.grab.max_acceleration * bodies.traits[i].mass * h;
    if (impulse.norm() > cap) impulse *= cap / impulse.norm();
    step.load[i].a_W += bodies.inertia[i].inv_mass / h * impulse;
    step.load[i].torque_W += r_W.cross(impulse) / h;
  }
}

}  // namespace rbs::grabs

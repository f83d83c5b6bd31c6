// SPDX-License-Identifier: BSD-3-Clause
#include "base/algebra.h"
#include "base/text.h"
#include "effects/effects.h"

#include <cmath>

namespace rbs::holds {

Need need(const SceneAnalysis& c) {
  if (c.holds == 0) return {false, "no body follows a drag"};
  return {true, count(c.holds, "body follows a drag", "bodies follow drags")};
}

// The body closes on its target as exp(-t/tau): quick enough to follow a mouse, and slow enough that a jump
// of the mouse is not a blow to what stands in the way.
void run(Context& context) {
  constexpr double kTau = 1.0 / 30.0;     // s
  constexpr double kRoundedTurn = 5e-16;  // of a quaternion
  Bodies& bodies = context.scene.bodies;
  const double h = context.step.h();
  const double rate = -std::expm1(-h / kTau) / h;
  for (const BodyHold& hold : context.scene.holds) {
    const Index i = bodies.indexOf(hold.body);
    if (i == kNone || bodies.traits[i].frozen) continue;
    const Pose& now = bodies.pose[i];
    const Eigen::AngleAxisd turn(Eigen::Quaterniond(hold.target.q_WB * now.q_WB.conjugate()).normalized());
    const double angle = turn.angle() > kPi ? turn.angle() - 2.0 * kPi : turn.angle();
    Twist& twist = bodies.twist[i];
    twist = {rate * (hold.target.p_WB - now.p_WB), rate * angle * turn.axis()};
    // It is there where a step would not take it further, but for rounding. What stands beside it may sleep then.
    if (now.p_WB + h * twist.v_WB == now.p_WB) twist.v_WB.setZero();
    const Quat next = rotationBy(h * twist.w_WB) * now.q_WB;
    if ((next.coeffs() - now.q_WB.coeffs()).norm() <= kRoundedTurn) twist.w_WB.setZero();
  }
}

}  // namespace rbs::holds

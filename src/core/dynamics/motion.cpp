// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/motion.h"

#include "base/algebra.h"
#include "dynamics/integrate.h"

namespace rbs {

std::pair<Pose, Twist> Motion::stateAt(double t) const {
  const double s = t - t0;
  if (s == 0.0) return {pose, twist};
  Quat q_WB = pose.q_WB;
  Vec3 w_WB = twist.w_WB;
  if (top != nullptr) {
    rotateFreely(q_WB, w_WB, *top, s);
  } else {
    q_WB = (rotationBy(s * w_WB) * q_WB).normalized();
  }
  return {{pose.p_WB + s * (twist.v_WB + 0.5 * s * a_W), q_WB}, {twist.v_WB + s * a_W, w_WB}};
}

SpinBounds Motion::spinBounds() const {
  if (top == nullptr) return {twist.w_WB.norm(), 0.0};
  return spinBoundsOf(pose.q_WB.conjugate() * twist.w_WB, *top);
}

Motion Motion::between(double t0, const Pose& from, double t1, const Pose& to) {
  const Eigen::AngleAxisd turn(to.q_WB * from.q_WB.conjugate());
  Motion motion;
  motion.t0 = t0;
  motion.pose = from;
  motion.twist = {(to.p_WB - from.p_WB) / (t1 - t0), turn.angle() / (t1 - t0) * turn.axis()};
  return motion;
}

}  // namespace rbs

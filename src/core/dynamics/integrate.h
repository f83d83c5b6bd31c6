// SPDX-License-Identifier: BSD-3-Clause
// Motion between contacts: exact flight under constant acceleration, and the free rotation of a body.
#pragma once

#include "dynamics/inertia.h"

namespace rbs {

/// Rotates a body freely for `dt` seconds: no torque acts, and its angular momentum is constant.
void rotateFreely(Quat& q_WB, Vec3& w_WB, const Inertia& inertia, double dt);

/// Moves a body for `dt` seconds under a constant acceleration and a constant torque, both in W.
/// The position is exact; the rotation is a symmetric splitting (half the torque before, half after a free
/// rotation), exact without torque where rotateFreely() is.
void fly(Pose& pose, Twist& twist, const Inertia& inertia, const Vec3& a_W, const Vec3& torque_W, double dt);

}  // namespace rbs

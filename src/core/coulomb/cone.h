// SPDX-License-Identifier: BSD-3-Clause
// The Coulomb problem of one contact point, solved exactly.
#pragma once

#include "rigid_body_sim/types.h"

namespace rbs {

/// The impulse r (tangents first, normal last) at a contact where an impulse r changes the relative velocity
/// u = W r + q, such that
///   0 <= r_n,  0 <= u_n,  r_n u_n = 0        (Signorini)
///   |r_T| <= mu r_n;  u_T = -a r_T, a >= 0, and |r_T| = mu r_n where it slides   (Coulomb).
/// W is symmetric positive definite, 1/kg; q in m/s; mu >= 0.
Vec3 solveContact(const Mat3& W, const Vec3& q, double mu);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Mass and moments of inertia of a rigid body.
#pragma once

#include "rigid_body_sim/types.h"

namespace rbs {

/// Mass and moments of inertia. The inverses are zero for a body that forces do not move.
struct Inertia {
  double inv_mass = 0.0;            ///< 1/kg
  Vec3 inv_moments = Vec3::Zero();  ///< about the axes of B, 1/(kg m²)
  Vec3 moments = Vec3::Zero();      ///< about the axes of B, kg m²; also for bodies that do not move
  bool isotropic = true;            ///< all moments equal
  bool gyroscopic = false;          ///< its angular velocity changes without torque
  /// Nothing changes its rotation: inv_moments are zero, its angular velocity is constant.
  bool steady = false;
  /// Steady, and no stage of a step uses its orientation, which is not integrated but computed when it is
  /// read.
  bool lazy_orientation = false;

  /// I_W^-1 for a body with the orientation R_WB.
  Mat3 inverseW(const Mat3& R_WB) const { return R_WB * inv_moments.asDiagonal() * R_WB.transpose(); }
};

}  // namespace rbs

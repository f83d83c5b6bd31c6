// SPDX-License-Identifier: BSD-3-Clause
// The part of a body below a plane.
#pragma once

#include "rigid_body_sim/shape.h"

namespace rbs {

struct SubmergedPart {
  double volume = 0.0;           ///< m³
  Vec3 centre_B = Vec3::Zero();  ///< its centre of volume, m
};

/// The part {x in B: up.x <= level} of a shape that is no plane. `up_B` is of unit length, `level` in m.
/// Exact to rounding; for capsules, cylinders and cones to 1e-12 of the volume and the size.
SubmergedPart submergedPart(const Shape& shape, const Vec3& up_B, double level);

}  // namespace rbs

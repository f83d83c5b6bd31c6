// SPDX-License-Identifier: BSD-3-Clause
// Time-of-impact queries (continuous collision detection): when two moving shapes first touch.
#pragma once

#include "dynamics/motion.h"
#include "rigid_body_sim/shape.h"

#include <optional>

namespace rbs {

/// The first time in [from, to] at which A and B touch while approaching each other. It is not later than
/// the truth by more than rounding, nor earlier by more than it takes to close 1e-14 of the smaller length,
/// or what rounding leaves of the gap (only a pair that turns through thousands of radians on the way may be
/// answered with an earlier time, while still apart). A pair that touches or overlaps at `from` (within 1e-12
/// of the smaller length) and approaches, or rests and is pressed together, is found at `from`; one that
/// separates is not found until it comes back. Empty when there is none, and for two planes. Adds the
/// number of closest-point queries to `looks`, where it is given; closed forms need none.
std::optional<double> timeOfImpact(const Shape& a, const Motion& motion_a, const Shape& b,
                                   const Motion& motion_b, double from, double to, int* looks = nullptr);

}  // namespace rbs

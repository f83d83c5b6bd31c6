// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rigid_body_sim/types.h"

namespace rbs {

/// Signed distance of A and B, with the closest points of their surfaces: p_WB - p_WA = distance n_W up to
/// rounding. Where there are several such pairs of points, one of them.
struct Gap {
  double distance;  ///< separation, m; negative: penetration depth. Infinite for two planes
  Vec3 n_W;         ///< unit, from A to B
  Vec3 p_WA, p_WB;  ///< of A and of B, m; zero for two planes
};

}  // namespace rbs

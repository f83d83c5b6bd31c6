// SPDX-License-Identifier: BSD-3-Clause
// Where two bodies met on simple paths: a search for what predictions have not seen, once it is known where bodies went.
#pragma once

#include "dynamics/motion.h"
#include "rigid_body_sim/shape.h"

#include <optional>

namespace rbs {

struct PathImpact {
  double time;    ///< the first at which they touch and close
  double beyond;  ///< how far they would go on into each other until the end at the speed of that time, m
};

/// Of A and B on their motions in [from, to]; empty where they do not meet. Costs a time of impact.
std::optional<PathImpact> impactOnPaths(const Shape& a, const Motion& path_a, const Shape& b,
                                        const Motion& path_b, double from, double to);

}  // namespace rbs

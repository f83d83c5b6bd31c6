// SPDX-License-Identifier: BSD-3-Clause
// The separating-axis test of two boxes.
#pragma once

#include "shapes/support.h"

#include <optional>

namespace rbs {

/// One of the fifteen candidates for a separating axis of two boxes.
struct BoxAxis {
  double separation;  ///< separation of the boxes along it, m; negative is penetration
  Vec3 n_A;           ///< unit, from A to B, in A's frame
  int edge_a = -1;    ///< axes of the edges that span it; -1 for the normal of a face
  int edge_b = -1;
};

/// The axis on which boxes of these half extents are farthest apart, or overlap least. Where axes tie up to
/// rounding, that of a face wins over that of two edges, and A's over B's. Empty as soon as one axis
/// separates the boxes by more than `margin`.
std::optional<BoxAxis> farthestAxis(const Vec3& half_a, const Vec3& half_b, const RelativePose& X_AB,
                                    double margin);

}  // namespace rbs

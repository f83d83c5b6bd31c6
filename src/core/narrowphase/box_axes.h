// SPDX-License-Identifier: BSD-3-Clause
// The separating-axis test of two boxes.
#pragma once

#include "narrowphase/support.h"

#include <optional>

namespace rbs {

/// One of the fifteen axes on which two boxes may be apart.
struct BoxAxis {
  double separation;  ///< gap of the boxes along it, m; negative is overlap
  Vec3 n_A;           ///< unit, from A to B, in A's frame
  int edge_a = -1;    ///< axes of the edges that span it; -1 for the normal of a face
  int edge_b = -1;
};

/// The axis on which boxes of these half extents are farthest apart, or overlap least: that of a face rather
/// than that of two edges, and of A rather than of B, where rounding cannot tell them apart. Empty as soon as
/// one separates them by more than `margin`.
std::optional<BoxAxis> farthestAxis(const Vec3& half_a, const Vec3& half_b, const RelativePose& X_AB,
                                    double margin);

}  // namespace rbs

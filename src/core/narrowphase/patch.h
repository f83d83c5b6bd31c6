// SPDX-License-Identifier: BSD-3-Clause
// The patch in which two facets lie on each other.
#pragma once

#include "narrowphase/facet.h"
#include "narrowphase/manifold.h"

namespace rbs {

/// Two convex shapes near each other, in A's frame.
struct FacingFacets {
  Facet a, b;
  double radius_a, radius_b;  ///< of the balls swept over the cores, m
  Vec3 n;                     ///< unit, from A to B
  Vec3 middle;                ///< midway between the nearest (or deepest) points
  double distance;            ///< separation of these along n, m; negative is penetration
  bool has_middle = true;     ///< whether `middle` is a point of contact where no corner comes as near
};

/// The corners of the patch that A's facet, seen along n, shares with B's, those whose gap along n is at most
/// `margin`; and the point `middle` where no corner comes as near as that, if it is one. In A's frame.
Manifold patchOf(const FacingFacets& facing, double margin);

}  // namespace rbs

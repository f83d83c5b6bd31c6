// SPDX-License-Identifier: BSD-3-Clause
// The collision table: which routine finds the manifold of which pair of shapes.
#pragma once

#include "narrowphase/manifold.h"
#include "narrowphase/simplex.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

/// The manifold of A at X_WA and B at X_WB: the points whose gap is at most `margin` (m, >= 0).
/// Overlaps of any depth are reported. Coincident centres give a fixed, deterministic normal. Two
/// planes never meet.
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);

/// Gap between A and B, with the points of their surfaces that span it: p_WB - p_WA = distance n_W up to
/// rounding. Where there are several such pairs of points, one of them.
struct Gap {
  double distance;  ///< m; negative: depth of the overlap. Infinite for two planes
  Vec3 n_W;         ///< unit, from A to B
  Vec3 p_WA, p_WB;  ///< of A and of B, m; zero for two planes
};
Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

/// Likewise, where the same pair is asked for again and again: `kept`, empty at first, is where the last
/// search ended, which shortens the next one. The poses may change as they like, the shapes may not.
Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Simplex& kept);

/// Whether the gap is at most `margin` (m, >= 0): sooner known than the gap.
bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The collision table: which routine finds the manifold of which pair of shapes.
#pragma once

#include "narrowphase/gap.h"
#include "narrowphase/manifold.h"
#include "narrowphase/separating_axis.h"
#include "narrowphase/simplex.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

/// The contact manifold of A at X_WA and B at X_WB: the points whose separation is at most `margin` (m, >=
/// 0). Penetration of any depth is reported. Coincident centres give a fixed, deterministic normal. Two
/// planes have no contact points.
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);
/// The same manifold, of a pair that is queried repeatedly. `axis` is the one of its last query, none at
/// first; pairs with a closed form leave it alone.
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 SeparatingAxis& axis);

/// The manifold of A and B along another normal of theirs: `normal` has a unit vector from A to B, the separation along it and
/// the points where they are nearest. Empty where no points of the two face each other along it. Neither may be a plane.
Manifold collideAlong(const Gap& normal, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                      double margin);

/// The gap of two shapes.
Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

/// The gap of a pair that is queried repeatedly. `kept` is the last simplex of the search, empty at first.
/// The next search starts from it, which shortens it. The poses may change in any way, the shapes may not.
Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Simplex& kept);

/// Whether the gap is at most `margin` (m, >= 0). Cheaper than the gap.
bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);
/// The same answer, of a pair that is queried repeatedly, as in collide().
bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
               SeparatingAxis& axis);

}  // namespace rbs

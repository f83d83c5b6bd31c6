// SPDX-License-Identifier: BSD-3-Clause
// The pairs of shapes with a method of their own: one manifold routine and one gap routine each. The other
// pairs use the templates of convex.h; an overload here replaces the template for a pair.
#pragma once

#include "narrowphase/gap.h"
#include "narrowphase/manifold.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

struct ConvexGap;  // convex.h
struct Search;

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB, double margin);
Gap gapPair(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB);

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin);
Gap gapPair(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB);

Manifold collidePair(const Sphere& a, const Pose& X_WA, const Plane& b, const Pose& X_WB, double margin);
Gap gapPair(const Sphere& a, const Pose& X_WA, const Plane& b, const Pose& X_WB);

/// Up to eight points where one box's face clips the other's, or the one point of two crossing edges, or,
/// for boxes with neither, their closest points. The normal is the separating axis on which the
/// boxes are farthest apart (or overlap least).
Manifold collidePair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin);
/// The points along the normal of a face.
Manifold collideAlongPair(const ConvexGap& gap, const Box& a, const Pose& X_WA, const Box& b,
                          const Pose& X_WB, double margin);
Gap gapPair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, const Search& search);
bool withinPair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin, Vec3& n_W);

}  // namespace rbs

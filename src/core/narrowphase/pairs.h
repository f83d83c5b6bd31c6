// The pairs of shapes with a closed form: one manifold routine and one gap routine each.
#pragma once

#include "narrowphase/collide.h"
#include "narrowphase/manifold.h"

namespace rbs {

Manifold collideSpheres(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB, double margin);
Gap gapSpheres(const Sphere& a, const Pose& X_WA, const Sphere& b, const Pose& X_WB);

Manifold collideSphereBox(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin);
Gap gapSphereBox(const Sphere& a, const Pose& X_WA, const Box& b, const Pose& X_WB);

Manifold collideSpherePlane(const Sphere& a, const Pose& X_WA, const Plane& b, const Pose& X_WB,
                            double margin);
Gap gapSpherePlane(const Sphere& a, const Pose& X_WA, const Plane& b, const Pose& X_WB);

/// The corners of the box within the margin of the plane; the feature is the number of the corner.
Manifold collideBoxPlane(const Box& a, const Pose& X_WA, const Plane& b, const Pose& X_WB, double margin);
Gap gapBoxPlane(const Box& a, const Pose& X_WA, const Plane& b, const Pose& X_WB);

/// Up to eight points where one box's face clips the other's, or the one point of two crossing edges, or,
/// for boxes that meet with neither, their nearest points. The normal is the separating axis on which the
/// boxes are farthest apart (or overlap least).
Manifold collideBoxes(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin);
Gap gapBoxes(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB);

}  // namespace rbs

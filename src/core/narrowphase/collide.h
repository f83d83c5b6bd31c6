// The collision table: which routine finds the manifold of which pair of shapes.
#pragma once

#include "narrowphase/manifold.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

/// The manifold of A at X_WA and B at X_WB: the points whose gap is at most `margin` (m, >= 0).
/// Overlaps of any depth are reported. Coincident centres give a fixed, deterministic normal. Two
/// planes never meet.
Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);

/// Gap between A and B (negative: overlap depth), with the unit normal from A to B.
struct Gap {
  double distance;
  Vec3 n_W;
};
Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

}  // namespace rbs

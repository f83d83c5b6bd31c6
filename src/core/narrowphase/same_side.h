// SPDX-License-Identifier: BSD-3-Clause
// The manifold of two shapes that have been pressed deep into each other, on the side from which they came.
//
// The narrow phase parts an overlap by the shortest way. Where a body has been pressed past the middle of a thin one,
// that way leads out on the other side, and contacts along it would complete the passage that they are there to
// prevent. Which side is right the shapes at one instant do not say; the normal n that their contact had before does.
// B is moved out along n until its support clears that of A, by -s_n (lasting_axis.h), and comes back along n. Where the
// two meet, at a time of impact, they would part on this side. With d the way from there to where B is, the manifold is
// that of the meeting, taken back: its points move by half of -d n, and their separations along its normal m shrink by
// d n.m.
#pragma once

#include "narrowphase/manifold.h"
#include "rigid_body_sim/shape.h"

namespace rbs {

/// The manifold of A and B, which overlap, that has its normal within a right angle of `n_W` (unit, from A to B), for
/// points that the same motion along n_W separates by at most `margin` (m, >= 0). Neither may be a plane. Costs a time of
/// impact and a collide().
Manifold manifoldOnSide(const Vec3& n_W, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        double margin);

}  // namespace rbs

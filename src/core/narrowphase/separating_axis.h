// SPDX-License-Identifier: BSD-3-Clause
// The separating axis of a pair, kept from one query to the next.
//
// Two convex shapes are apart by more than a margin when they are so along one direction. Bodies move little
// from query to query, so the direction that proved it last proves it again, for two support queries in place
// of a search. (G. van den Bergen, "Collision Detection in Interactive 3D Environments", 2003, 4.3.6, keeps
// the separating axis of GJK in the same way.) The axis is only tried: it decides how fast an answer is found
// and not which, so that it is neither saved nor hashed.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <cstdint>

namespace rbs {

/// Separation of A and B along the unit vector n_W, m: the least n_W.x over B minus the largest over A. It is
/// at most their distance. Neither may be a plane.
double separationAlong(const Vec3& n_W, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

struct SeparatingAxis {
  Vec3 n_A = Vec3::Zero();    ///< unit, from A to B, in A's frame; zero: none is known
  std::uint32_t queries = 0;  ///< searches that it was tried before
  std::uint32_t kept = 0;     ///< those that it made unnecessary

  /// Whether A and B are apart along it by more than `margin` (m) and what rounding may hide. Counts.
  bool separates(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);
  /// Takes an axis from A to B, in W; zero: none is known.
  void set(const Pose& X_WA, const Vec3& n_W) { n_A = X_WA.q_WB.conjugate() * n_W; }
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Questions about a world as a snapshot shows it: what a ray meets, how far two bodies are apart, what is in
// a place.
//
// A snapshot never changes, so that they can be asked from any thread while the simulation runs, and change
// nothing: Simulator::snapshot() costs nothing, World::snapshot() a copy of all states. Every function
// throws InvalidInput with all that is wrong with the question.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <limits>
#include <optional>
#include <vector>

namespace rbs {

struct Ray {
  Vec3 origin_W = Vec3::Zero();                                   ///< m
  Vec3 direction_W = Vec3::UnitX();                               ///< of any length but 0
  double max_distance = std::numeric_limits<double>::infinity();  ///< m, > 0
  std::vector<BodyId> ignore;                                     ///< bodies that it passes through
};

/// Where a ray enters a body. A body that holds the origin is hit there: at distance 0, with the normal
/// against the ray.
struct RayHit {
  BodyId body;
  Vec3 p_W;         ///< m
  Vec3 n_W;         ///< outward unit normal of the body
  double distance;  ///< from the origin, m, >= 0
};

/// The first body that the ray meets, and of several at the same distance the one created first; empty when
/// there is none. A ray that only grazes a body may meet or miss it, by rounding.
std::optional<RayHit> castRay(const Snapshot& snapshot, const Ray& ray);

/// All bodies that the ray meets, the nearest first.
std::vector<RayHit> castRayThrough(const Snapshot& snapshot, const Ray& ray);

/// The points at which two bodies are nearest to each other, or overlap most deeply: p_WB - p_WA = distance
/// n_W up to rounding. Where there are several such pairs of points, one of them.
struct ClosestPoints {
  double distance;  ///< m; negative: how far b must move along n_W to leave a
  Vec3 n_W;         ///< unit, from a to b
  Vec3 p_WA, p_WB;  ///< on the surfaces of a and b, m
};

/// Two different bodies, not both planes.
ClosestPoints closestPoints(const Snapshot& snapshot, BodyId a, BodyId b);

/// A body near a place.
struct Neighbour {
  BodyId body;
  double distance;  ///< m; negative: depth of the overlap
};

/// The bodies that are within `margin` (m, >= 0) of a shape at `pose`; with 0 those that touch or overlap it.
/// In canonical order. A plane meets no planes.
std::vector<Neighbour> overlaps(const Snapshot& snapshot, const Shape& shape, const Pose& pose,
                                double margin = 0.0);

}  // namespace rbs

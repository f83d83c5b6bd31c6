// SPDX-License-Identifier: BSD-3-Clause
// Queries on a snapshot of a world: ray casts, closest points, overlaps with a shape.
//
// A snapshot never changes. So a query may run in any thread while the simulation runs; it changes and wakes
// nothing. Simulator::snapshot() copies a pointer, World::snapshot() copies all states. Every query throws
// InvalidInput with all faults of its arguments.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <limits>
#include <optional>
#include <vector>

namespace rbs {

/// A ray for castRay() and castRayThrough().
struct Ray {
  Vec3 origin_W = Vec3::Zero();  ///< start of the ray in W, m; each component at most Limits::max_position
  Vec3 direction_W = Vec3::UnitX();  ///< direction in W, finite, of any length but 0
  double max_distance = std::numeric_limits<double>::infinity();  ///< length of the ray, m, > 0
  std::vector<BodyId> ignore;  ///< bodies that the ray passes through; unknown handles do nothing
};

/// Where a ray enters a body. A body that holds the origin is hit there: at distance 0, with the normal
/// against the ray.
struct RayHit {
  BodyId body;      ///< the body that is hit
  Vec3 p_W;         ///< point of entry in W, m
  Vec3 n_W;         ///< outward unit normal of the body there, in W
  double distance;  ///< distance from the origin of the ray, m, >= 0
};

/// The first body that the ray hits. Of several at the same distance it is the one created first. Empty where
/// the ray hits nothing. A ray that only grazes a body may hit or miss it, by rounding. The cost is
/// proportional to the number of bodies. Throws InvalidInput for a faulty ray.
std::optional<RayHit> castRay(const Snapshot& snapshot, const Ray& ray);

/// All bodies that the ray hits, the nearest first; those at one distance in canonical order. The cost is
/// proportional to the number of bodies. Throws InvalidInput for a faulty ray.
std::vector<RayHit> castRayThrough(const Snapshot& snapshot, const Ray& ray);

/// The points at which two bodies a and b are nearest to each other, or overlap most deeply:
/// p_WB - p_WA = distance n_W up to rounding. Where there are several such pairs of points, it is one of
/// them.
struct ClosestPoints {
  double distance;  ///< separation, m; negative: penetration depth, by which b must move along n_W to leave a
  Vec3 n_W;         ///< unit normal in W, from a to b
  Vec3 p_WA,        ///< point on the surface of a, in W, m
      p_WB;         ///< point on the surface of b, in W, m
};

/// The closest points of two bodies. Throws InvalidInput where a body is not in the snapshot, where both are
/// the same, and where both are planes. Cost: one query of the narrow phase.
ClosestPoints closestPoints(const Snapshot& snapshot, BodyId a, BodyId b);

/// A body near the shape of overlaps().
struct Neighbour {
  BodyId body;      ///< the body
  double distance;  ///< separation from the shape, m; negative: penetration depth
};

/// The bodies within `margin` (m, 0 to Limits::max_position) of a shape at `pose`, in canonical order. With a
/// margin of 0 these are the bodies that touch or overlap it. A plane meets no planes. Throws InvalidInput
/// for a faulty shape, pose or margin. Cost: a distance check of all bodies, and a query of the narrow phase
/// for each body whose bounding ball is within the margin.
std::vector<Neighbour> overlaps(const Snapshot& snapshot, const Shape& shape, const Pose& pose,
                                double margin = 0.0);

}  // namespace rbs

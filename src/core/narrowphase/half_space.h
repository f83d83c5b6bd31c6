// SPDX-License-Identifier: BSD-3-Clause
// Any convex shape against a half-space: the heights of its points that face the plane.
#pragma once

#include "narrowphase/facet.h"
#include "narrowphase/gap.h"
#include "narrowphase/manifold.h"
#include "narrowphase/tolerances.h"
#include "rigid_body_sim/shape.h"
#include "shapes/support.h"

#include <limits>

namespace rbs {

template <class Convex>
Gap gapPair(const Convex& a, const Pose& X_WA, const Plane& /*b*/, const Pose& X_WB) {
  const Vec3 up_W = X_WB.q_WB * Vec3::UnitZ();
  const Vec3 core_A = coreOf(a)(X_WA.q_WB.conjugate() * -up_W);
  const Vec3 lowest_W = X_WA.p_WB + X_WA.q_WB * core_A - coreRadius(a) * up_W;
  const double height = up_W.dot(lowest_W - X_WB.p_WB);
  return {height, -up_W, lowest_W, lowest_W - height * up_W};
}

// The points of a shape that may stand on a plane with the downward normal d: the facet that faces it, or all
// corners of a box, because two of its faces may be near.
template <class Convex>
Facet feet(const Convex& shape, const Vec3& d) {
  return facetTowards(shape, d);
}
inline Facet feet(const Box& box, const Vec3& /*d*/) {
  Facet corners = facetTowards(box, Vec3::UnitZ());
  const Facet lower = facetTowards(box, -Vec3::UnitZ());
  for (int k = 0; k < lower.size; ++k) corners.add(lower.corners[k], lower.ids[k]);
  return corners;
}

/// The feet within the margin, and the lowest point where it is none of them. The feature of a foot is its
/// number.
template <class Convex>
Manifold collidePair(const Convex& a, const Pose& X_WA, const Plane& b, const Pose& X_WB, double margin) {
  const Gap gap = gapPair(a, X_WA, b, X_WB);
  const Vec3 up_W = -gap.n_W;
  Manifold manifold;
  manifold.n_W = gap.n_W;
  if (gap.distance > margin) return manifold;
  const Facet facet = feet(a, X_WA.q_WB.conjugate() * gap.n_W);
  double lowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < facet.size; ++k) {
    const Vec3 point_W = X_WA.p_WB + X_WA.q_WB * facet.corners[k] - coreRadius(a) * up_W;
    const double height = up_W.dot(point_W - X_WB.p_WB);
    if (height > margin) continue;
    lowest = std::min(lowest, height);
    manifold.add(point_W - 0.5 * height * up_W, height, facet.ids[k]);
  }
  if (lowest > gap.distance + kCovers * characteristicLength(a))
    manifold.add(0.5 * (gap.p_WA + gap.p_WB), gap.distance, facet.farthest_id);
  return manifold;
}

inline Manifold collidePair(const Plane&, const Pose&, const Plane&, const Pose&, double) {
  return {};
}

inline Gap gapPair(const Plane&, const Pose&, const Plane&, const Pose&) {
  return {std::numeric_limits<double>::infinity(), Vec3::UnitZ(), Vec3::Zero(), Vec3::Zero()};
}

}  // namespace rbs

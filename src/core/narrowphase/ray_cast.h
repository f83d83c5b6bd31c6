// SPDX-License-Identifier: BSD-3-Clause
// Where a ray enters a shape.
#pragma once

#include "narrowphase/simplex.h"
#include "narrowphase/tolerances.h"
#include "rigid_body_sim/shape.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace rbs {

/// Where a ray enters a shape, in the shape's frame.
struct RayEntry {
  double distance;  ///< along the ray, m, >= 0; 0 if it starts in or on the shape
  Vec3 n_B;         ///< outward unit normal there; against the ray if it starts inside
};

/// The entry of the ray from `origin_B` along the unit vector `d_B` into the shape; empty if it misses.
std::optional<RayEntry> castRay(const Shape& shape, const Vec3& origin_B, const Vec3& d_B);

/// The entry of the ray into a core with a ball of some radius swept over it, by its support function alone:
/// G. van den Bergen, "Ray casting against general convex objects with application to continuous collision
/// detection", 2004. Every plane that bounds the shape and has the ray's tip in front of it lets the tip
/// advance to it, never past the entry. The planes are those that GJK finds on its way from the tip to the
/// core. With a core that is a point, a segment or a polytope a few planes lead onto the entry, exact to
/// rounding; along a curved core convergence is slow and loses a digit.
template <class Core>
std::optional<RayEntry> castRayOnSupport(const Core& core, double radius, const Vec3& origin_B,
                                         const Vec3& d_B) {
  constexpr int kIterations = 128;
  RayEntry entry{0.0, -d_B};
  Vec3 tip = origin_B;
  const auto fromTip = [&](const Vec3& p) { return SupportPoint{p - tip, p, tip, Vec3::Zero(), false}; };

  double scale = tip.cwiseAbs().maxCoeff() + radius;
  const double last = d_B.dot(core(d_B) - origin_B) + radius;  // beyond it there is nothing of the shape
  Simplex simplex;
  simplex.add(fromTip(core(tip)));
  for (int k = 0; k < kIterations; ++k) {
    const Vec3 v = reduceToNearest(simplex);
    const double distance = v.norm(), rounding = kRounding * scale;
    if (simplex.size == 4 || distance - radius <= rounding) break;
    const SupportPoint p = fromTip(core(-v));
    scale = std::max(scale, p.a.cwiseAbs().maxCoeff());
    const double gap = v.dot(p.w) / distance - radius;  // of the tip, to the plane through p across v
    if (gap > 0.0) {
      const double approach = v.dot(d_B) / distance;
      if (!(approach > 0.0)) return std::nullopt;
      entry = {entry.distance + gap / approach, v / -distance};
      if (entry.distance > last + rounding) return std::nullopt;
      const Vec3 advanced = origin_B + entry.distance * d_B;
      if (advanced == tip) break;
      tip = advanced;
      for (int i = 0; i < simplex.size; ++i) simplex.points[i] = fromTip(simplex.points[i].a);
    } else if (simplex.contains(p.w)) {
      break;
    }
    const SupportPoint next = fromTip(p.a);
    if (!simplex.contains(next.w)) simplex.add(next);
  }
  return entry;
}

}  // namespace rbs

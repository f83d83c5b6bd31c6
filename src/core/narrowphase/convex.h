// SPDX-License-Identifier: BSD-3-Clause
// Gap, manifold and intersection of any two convex shapes with support functions, by GJK and EPA.
#pragma once

#include "narrowphase/epa.h"
#include "narrowphase/facet.h"
#include "narrowphase/finish.h"
#include "narrowphase/gap.h"
#include "narrowphase/gjk.h"
#include "narrowphase/manifold.h"
#include "narrowphase/patch.h"
#include "rigid_body_sim/shape.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>

namespace rbs {

/// The gap of two convex shapes and their closest points.
struct ConvexGap {
  double distance;
  Vec3 n_A;       ///< unit, from A to B, in A's frame
  Vec3 middle_A;  ///< midway between the two nearest (or deepest) points, in A's frame
};

// The closed form of a pair, where there is one.
ConvexGap convexGap(const Sphere& a, const Capsule& b, const RelativePose& X_AB);
ConvexGap convexGap(const Sphere& a, const Cylinder& b, const RelativePose& X_AB);
ConvexGap convexGap(const Sphere& a, const Cone& b, const RelativePose& X_AB);
ConvexGap convexGap(const Capsule& a, const Capsule& b, const RelativePose& X_AB);

/// The pairs without a closed form.
template <class ShapeA, class ShapeB>
inline constexpr bool kSearched =
    !std::is_same_v<ShapeB, Plane> &&
    !(std::is_same_v<ShapeA, Sphere> && !std::is_same_v<ShapeB, ConvexHull>)&&  //
    !(std::is_same_v<ShapeA, Capsule> && std::is_same_v<ShapeB, Capsule>);

/// The pairs whose separating axis is worth keeping: to try one costs boxes as much as to find it.
template <class ShapeA, class ShapeB>
inline constexpr bool kKeepsAxis =
    kSearched<ShapeA, ShapeB> && !(std::is_same_v<ShapeA, Box> && std::is_same_v<ShapeB, Box>);

/// Options of a search for a gap. Where the gap is above `beyond` (m), the result is only some number between
/// the two, with the last direction that was searched. `kept` is the last simplex of an earlier search for this
/// pair at nearby poses (of size 0: none), and then that of this search.
struct Search {
  double beyond = std::numeric_limits<double>::infinity();
  Simplex* kept = nullptr;
};

/// By GJK, and by EPA where the cores overlap.
template <class ShapeA, class ShapeB>
ConvexGap convexGap(const ShapeA& a, const ShapeB& b, const RelativePose& X_AB, const Search& search = {}) {
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  const Finish finish(coreOf(a), coreOf(b), X_AB);
  const double radii = coreRadius(a) + coreRadius(b);
  const Enough enough{search.beyond + radii};
  Simplex start;
  for (int k = 0; search.kept != nullptr && k < search.kept->size; ++k) {
    const SupportPoint& kept = search.kept->points[k];
    start.add(difference.pointOf(kept.a, kept.b_B));
    start.points[k].between = kept.between;
  }
  const GjkResult distance = start.size > 0 ? gjk(difference, start, finish, enough)
                                            : gjk(difference, difference.centre(), finish, enough);
  if (search.kept != nullptr) *search.kept = distance.simplex;
  if (distance.enough) return {distance.lower - radii, -distance.v.normalized(), Vec3::Zero()};
  Vec3 on_a, on_b;
  ConvexGap gap;
  // For cores this near, v has no direction, or a bad one where v does not prove its length. EPA finds a
  // better direction.
  constexpr double kCoresTouch = 1e-13, kCoresNear = 1e-6,
                   kProved = 64.0 * std::numeric_limits<double>::epsilon();
  const bool proved = distance.upper - distance.lower <= kProved * distance.scale;
  if (!distance.overlap &&
      (distance.finished || distance.upper > (proved ? kCoresTouch : kCoresNear) * distance.scale)) {
    gap.n_A = distance.n;
    gap.distance = distance.finished ? distance.lower : distance.upper;
    on_a = distance.simplex.witnessA(), on_b = distance.simplex.witnessB();
  } else {
    EpaResult depth = [&] {
      if constexpr (finish.kRound)
        return epa(std::cref(difference), distance.simplex, distance.scale, std::cref(finish));
      else
        return epa(std::cref(difference), distance.simplex, distance.scale);
    }();
    if (!distance.n.isZero(0.0)) {
      const double upper = distance.n.dot(difference(distance.n).w);
      if (upper < depth.upper - kCoresNear * distance.scale)  // the result of EPA contradicts that of GJK
        depth.a = distance.simplex.witnessA(), depth.b = distance.simplex.witnessB();
      if (upper < depth.upper) depth.n = distance.n, depth.upper = upper;
    }
    gap.n_A = depth.n;
    // The bounds may cross by rounding. The lower bound, which is proved, then counts.
    gap.distance =
        distance.overlap ? -depth.upper : std::max(distance.lower, std::min(-depth.upper, distance.upper));
    on_a = depth.a, on_b = depth.b;
  }
  gap.distance -= radii;
  gap.middle_A = 0.5 * (on_a + coreRadius(a) * gap.n_A + on_b - coreRadius(b) * gap.n_A);
  return gap;
}

template <class ShapeA, class ShapeB>
RelativePose relativePose(const Pose& X_WA, const Pose& X_WB) {
  using Cores = Finish<decltype(coreOf(std::declval<ShapeA>())), decltype(coreOf(std::declval<ShapeB>()))>;
  if constexpr (Cores::kRound && kSearched<ShapeA, ShapeB>)
    return RelativePose::withAllDigits(X_WA, X_WB);
  else
    return RelativePose(X_WA, X_WB);
}

/// An order of poses that does not depend on which shape is called A.
inline bool comesBefore(const Pose& x, const Pose& y) {
  const auto coordinates = [](const Pose& pose) {
    const Vec3& p = pose.p_WB;
    const Quat& q = pose.q_WB;
    return std::array{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
  };
  return coordinates(x) < coordinates(y);
}

/// Two shapes of one kind are measured in the order of their poses, so that the gap does not depend on which
/// of them is A. Where a simplex is kept, they are measured in the given order, because poses change. For two
/// kinds the order of the kinds decides (collide.cpp).
template <class ShapeA, class ShapeB>
ConvexGap convexGap(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                    const Search& search = {}) {
  const auto measure = [&](const ShapeA& first, const ShapeB& second, const RelativePose& X) {
    if constexpr (kSearched<ShapeA, ShapeB>)
      return convexGap(first, second, X, search);
    else
      return convexGap(first, second, X);
  };
  if constexpr (std::is_same_v<ShapeA, ShapeB>) {
    if (search.kept == nullptr && comesBefore(X_WB, X_WA)) {
      const RelativePose X_BA = relativePose<ShapeB, ShapeA>(X_WB, X_WA);
      const ConvexGap gap = measure(b, a, X_BA);
      const Mat3 R_AB = X_BA.R_AB.transpose();
      return {gap.distance, R_AB * -gap.n_A, R_AB * (gap.middle_A - X_BA.p_AB)};
    }
  }
  return measure(a, b, relativePose<ShapeA, ShapeB>(X_WA, X_WB));
}

/// The gap whose closest points lie half of it to either side of `middle_W`.
inline Gap spanAbout(const Vec3& middle_W, double distance, const Vec3& n_W) {
  return {distance, n_W, middle_W - 0.5 * distance * n_W, middle_W + 0.5 * distance * n_W};
}

template <class ShapeA, class ShapeB>
Gap gapConvex(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
              const Search& search = {}) {
  const ConvexGap gap = convexGap(a, X_WA, b, X_WB, search);
  return spanAbout(X_WA.p_WB + X_WA.q_WB * gap.middle_A, gap.distance, X_WA.q_WB * gap.n_A);
}

/// The manifold along the direction of a gap. `is_nearest`: its closest points are, so that there is a point of contact at least.
template <class ShapeA, class ShapeB>
Manifold convexManifold(const ConvexGap& gap, bool is_nearest, const ShapeA& a, const Pose& X_WA,
                        const ShapeB& b, const Pose& X_WB, double margin) {
  Manifold manifold;
  manifold.n_W = X_WA.q_WB * gap.n_A;
  if (gap.distance > margin) return manifold;
  const RelativePose X_AB(X_WA, X_WB);
  Facet facet_b = facetTowards(b, X_AB.R_AB.transpose() * -gap.n_A);
  for (int k = 0; k < facet_b.size; ++k) facet_b.corners[k] = X_AB.p_AB + X_AB.R_AB * facet_b.corners[k];
  const Manifold patch = patchOf({facetTowards(a, gap.n_A), facet_b, coreRadius(a), coreRadius(b), gap.n_A,
                                  gap.middle_A, gap.distance, is_nearest},
                                 margin);
  for (int k = 0; k < patch.size; ++k) {
    const ManifoldPoint& point = patch.points[k];
    manifold.add(X_WA.p_WB + X_WA.q_WB * point.p_W, point.separation, point.feature);
  }
  return manifold;
}

template <class ShapeA, class ShapeB>
Manifold collideConvex(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, double margin) {
  return convexManifold(convexGap(a, X_WA, b, X_WB, {margin, nullptr}), true, a, X_WA, b, X_WB, margin);
}

// The methods for two kinds of shapes without a method of their own.
template <class ShapeA, class ShapeB>
Gap gapPair(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Search& search = {}) {
  return gapConvex(a, X_WA, b, X_WB, search);
}
/// Whether the gap is at most `margin`. A point of A - B that is near enough, or a separating plane that is
/// far enough, ends the search. Where both leave it open, the gap decides. Where it is not, `n_W` is an axis
/// that separates the two, from A to B, if the pair keeps it.
template <class ShapeA, class ShapeB>
bool withinPair(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, double margin,
                Vec3& n_W) {
  if constexpr (kSearched<ShapeA, ShapeB>) {
    const CoreDifference difference(coreOf(a), coreOf(b), RelativePose(X_WA, X_WB));
    const double reach = margin + coreRadius(a) + coreRadius(b);
    const GjkResult distance = gjk(difference, difference.centre(), NoFinish(), {reach, reach});
    n_W = X_WA.q_WB * -distance.v.normalized();
    if (distance.enough) return !(distance.lower > reach);
    if (distance.simplex.size == 4) return true;
  }
  return gapPair(a, X_WA, b, X_WB).distance <= margin;
}
template <class ShapeA, class ShapeB>
Manifold collidePair(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, double margin) {
  return collideConvex(a, X_WA, b, X_WB, margin);
}
template <class ShapeA, class ShapeB>
Manifold collideAlongPair(const ConvexGap& gap, const ShapeA& a, const Pose& X_WA, const ShapeB& b,
                          const Pose& X_WB, double margin) {
  return convexManifold(gap, false, a, X_WA, b, X_WB, margin);
}

}  // namespace rbs

// Any two convex shapes, by GJK and EPA: what a new shape gets for a support function.
#pragma once

#include "narrowphase/collide.h"
#include "narrowphase/epa.h"
#include "narrowphase/gjk.h"
#include "narrowphase/manifold.h"

namespace rbs {

/// The gap of two convex shapes and the points of their surfaces that span it.
struct ConvexGap {
  double distance;
  Vec3 n_A;       ///< unit, from A to B, in A's frame
  Vec3 middle_A;  ///< midway between the two nearest (or deepest) points, in A's frame
};

template <class ShapeA, class ShapeB>
ConvexGap convexGap(const ShapeA& a, const ShapeB& b, const RelativePose& X_AB) {
  // Cores nearer than this fraction of their coordinates have no direction in GJK's v; EPA finds one.
  constexpr double kTouching = 1e-13;
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  const GjkResult distance = gjk(difference, difference.centre());
  Vec3 on_a, on_b;
  ConvexGap gap;
  if (!distance.overlap && distance.upper > kTouching * distance.scale) {
    gap.n_A = distance.v / -distance.upper;
    gap.distance = distance.upper;
    on_a = distance.simplex.witnessA(), on_b = distance.simplex.witnessB();
  } else {
    const EpaResult depth = epa(std::cref(difference), distance.simplex, distance.scale);
    gap.n_A = depth.n;
    gap.distance = -depth.upper;
    on_a = depth.a, on_b = depth.b;
  }
  gap.distance -= coreRadius(a) + coreRadius(b);
  gap.middle_A = 0.5 * (on_a + coreRadius(a) * gap.n_A + on_b - coreRadius(b) * gap.n_A);
  return gap;
}

/// The gap whose points lie half of it to either side of `middle_W`.
inline Gap spanAbout(const Vec3& middle_W, double distance, const Vec3& n_W) {
  return {distance, n_W, middle_W - 0.5 * distance * n_W, middle_W + 0.5 * distance * n_W};
}

template <class ShapeA, class ShapeB>
Gap gapConvex(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const ConvexGap gap = convexGap(a, b, RelativePose(X_WA, X_WB));
  return spanAbout(X_WA.p_WB + X_WA.q_WB * gap.middle_A, gap.distance, X_WA.q_WB * gap.n_A);
}

template <class ShapeA, class ShapeB>
Manifold collideConvex(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, double margin) {
  const ConvexGap gap = convexGap(a, b, RelativePose(X_WA, X_WB));
  Manifold manifold;
  manifold.n_W = X_WA.q_WB * gap.n_A;
  if (gap.distance <= margin) manifold.add(X_WA.p_WB + X_WA.q_WB * gap.middle_A, gap.distance, 0);
  return manifold;
}

// Against a half-space: the point of the shape that is lowest over it.
template <class Convex>
Gap gapConvexPlane(const Convex& a, const Pose& X_WA, const Plane& /*b*/, const Pose& X_WB) {
  const Vec3 up_W = X_WB.q_WB * Vec3::UnitZ();
  const Vec3 core_A = coreOf(a)(X_WA.q_WB.conjugate() * -up_W);
  const Vec3 lowest_W = X_WA.p_WB + X_WA.q_WB * core_A - coreRadius(a) * up_W;
  const double height = up_W.dot(lowest_W - X_WB.p_WB);
  return {height, -up_W, lowest_W, lowest_W - height * up_W};
}

template <class Convex>
Manifold collideConvexPlane(const Convex& a, const Pose& X_WA, const Plane& b, const Pose& X_WB,
                            double margin) {
  const Gap gap = gapConvexPlane(a, X_WA, b, X_WB);
  Manifold manifold;
  manifold.n_W = gap.n_W;
  if (gap.distance <= margin) manifold.add(0.5 * (gap.p_WA + gap.p_WB), gap.distance, 0);
  return manifold;
}

}  // namespace rbs

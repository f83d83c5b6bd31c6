// SPDX-License-Identifier: BSD-3-Clause
// The distance of two convex sets: E. G. Gilbert, D. W. Johnson, S. S. Keerthi, "A fast procedure for
// computing the distance between complex objects in three-dimensional space", IEEE J. Robotics Autom. 4(2),
// 1988.
//
// The distance of A and B is that of the origin from A - B = {a - b}. A simplex inside A - B walks towards
// the origin: with v its nearest point, w = support(-v) is the point of A - B farthest towards the origin,
// and since A - B lies beyond the plane through w normal to v,
//   v.w / |v|  <=  distance  <=  |v|.
// All tolerances are relative to the size of the coordinates, so that scale does not matter.
#pragma once

#include "narrowphase/simplex.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <limits>

namespace rbs {

struct GjkResult {
  Vec3 v = Vec3::Zero();  ///< nearest point of A - B to the origin: witness of A minus witness of B
  double upper = 0.0;     ///< |v|: upper bound of the distance
  double lower =
      -std::numeric_limits<double>::infinity();  ///< lower bound of the distance; 0 where the sets overlap
  Vec3 n = Vec3::Zero();  ///< unit, from A to B: that of v, or another with a better lower bound; 0: none
  bool finished = false;  ///< n proves `lower`: it is the direction of features, known to rounding
  bool enough = false;    ///< the search ended because the required bound was reached; n is not set then
  bool overlap = false;   ///< the origin is inside A - B, or nearer than rounding can resolve
  double scale = 0.0;     ///< largest coordinate, m: the unit of rounding
  int iterations = 0;     ///< kGjkIterations when it was cut off; the interval still holds
  Simplex simplex;        ///< last simplex, with the weights of v
};

inline constexpr int kGjkIterations = 128;

/// What two features prove of all directions n that are pinned to a circle, n.axis = cosine, at once: A - B
/// reaches `height` along each of them, at points of which some lie `reach` beyond the line through the
/// origin along n to either side of the circle.
struct Belt {
  Vec3 axis = Vec3::UnitZ();
  double cosine = 0.0;
  double height = -std::numeric_limits<double>::infinity(), reach = 0.0;
};

/// Result of refining a direction: the direction (unit, from A to B), points of A - B that span what is
/// nearest along it, none where that is not known, and the axis through the origin of each shape's frame
/// about which it is a solid of revolution (unit, in A's frame), 0 where it is none. Where a flat round side
/// is nearest, `nearest` is one point and the disc of the radius `margin` about it lies in that side.
struct Finished {
  Vec3 n;
  Simplex nearest;
  double margin = 0.0;
  Vec3 axis_a = Vec3::Zero(), axis_b = Vec3::Zero();
  std::array<Belt, 4>
      belts{};  ///< of the circle that n is pinned to, where such a direction was searched for
};

/// Where to look for a direction: where the separation is stationary, or at the nearest one among those to
/// which an edge or a line on the side of one of the shapes pins it.
enum class Seek { Stationary, PinnedByA, PinnedByB };

/// For sets with unknown features.
struct NoFinish {
  static constexpr bool kRound = false;
  Finished operator()(const Vec3& n, const SupportPoint* /*points*/, int /*size*/) const {
    return {n, {}, 0.0, Vec3::Zero(), Vec3::Zero(), {}};
  }
};

/// Required result, m: the search ends once the distance is known to be above `beyond` or at most `within`.
/// With the defaults the distance is computed.
struct Enough {
  double beyond = std::numeric_limits<double>::infinity();
  double within = -std::numeric_limits<double>::infinity();
};

/// `support(d)` gives the SupportPoint of A - B farthest along d; `start` holds 1 to 4 points of A - B: any
/// do, and the last simplex of an earlier call at nearby poses saves most of the work. `finish` refines a
/// direction (finish.h); the refined direction is used where its lower bound is better. Round sets need it
/// throughout, other sets only where the last v does not prove its length.
template <class Support, class Finish = NoFinish>
GjkResult gjk(const Support& support, const Simplex& start, const Finish& finish = {},
              const Enough& enough = {}) {
  constexpr int kStalls = 4;
  // The features are known when the interval is this small a fraction of the size, or of the distance.
  constexpr double kFeatures = 0.02;
  int stalls = 0;
  bool trusted = true;  // the last refined direction made progress
  double along = -std::numeric_limits<double>::infinity();
  double proved = -std::numeric_limits<double>::infinity();  // by best_v
  Vec3 best_v = Vec3::Zero();
  GjkResult result;
  const auto measure = [&](const SupportPoint& p) {
    result.scale = std::max({result.scale, p.a.cwiseAbs().maxCoeff(), p.b.cwiseAbs().maxCoeff()});
  };
  // Corners this near to each other may hide a better direction in a distance that is known to rounding.
  constexpr double kCorner = 1e-6;
  const auto nearCorner = [&](const Vec3& w) {
    if (Finish::kRound) return false;
    for (int i = 0; i < result.simplex.size; ++i)
      if (const double d = (result.simplex.points[i].w - w).norm(); d > 0.0 && d < kCorner * result.scale)
        return !result.simplex.contains(w);
    return false;
  };
  result.simplex = start;
  for (int i = 0; i < start.size; ++i) measure(start.points[i]);
  result.v = reduceToNearest(result.simplex);
  result.upper = result.v.norm();
  result.overlap = result.simplex.size == 4;

  for (; !result.overlap && result.iterations < kGjkIterations; ++result.iterations) {
    const double rounding = kRounding * result.scale;
    if (result.upper <= rounding) {
      result.overlap = true;
      break;
    }
    if (result.lower > enough.beyond + rounding || result.upper < enough.within - rounding) {
      result.enough = true;
      return result;
    }
    SupportPoint p;
    bool known = true;    // p is a corner of the simplex
    bool gained = false;  // `lower` has grown by more than rounding
    if constexpr (Finish::kRound) {
      if (trusted && result.upper - along <= kFeatures * std::max(result.scale, result.upper)) {
        Finished finished =
            finish(result.v / -result.upper, result.simplex.points.data(), result.simplex.size);
        p = support(finished.n);
        measure(p);
        const double separation = -finished.n.dot(p.w);
        if (separation >= result.lower - rounding) {
          result.n = finished.n, result.finished = true;
          result.lower = std::max(result.lower, separation);
          if (finished.nearest.size > 0) {
            const Vec3 v = reduceToNearest(finished.nearest);
            if (const double length = v.norm(); finished.nearest.size < 4 && length < result.upper)
              result.simplex = finished.nearest, result.v = v, result.upper = length;
          }
          if (result.upper - result.lower <= rounding) break;
          known = result.simplex.contains(p.w);
        }
      }
    }
    if (known) {
      p = support(-result.v);
      measure(p);
      along = result.v.dot(p.w) / result.upper;
      gained = along > result.lower + rounding;
      if (along > result.lower + (result.finished ? rounding : 0.0))
        result.lower = along, result.finished = false;
      if (along > proved + rounding) proved = along, best_v = result.v;
      if (result.upper - result.lower <= rounding ? !nearCorner(p.w) : result.simplex.contains(p.w)) break;
    }

    Simplex simplex = result.simplex;
    simplex.add(p);
    const Vec3 v = reduceToNearest(simplex);
    const double length = v.norm();
    trusted = known || length < result.upper;
    if (!trusted) continue;
    // A step may leave v in place and still turn it, so that the next one makes progress. A step that
    // rounding reverses is not taken.
    if (simplex.size < 4 && !(length < result.upper) &&
        ((!gained && ++stalls > kStalls) || length > result.upper + rounding))
      break;
    result.simplex = simplex;
    result.v = v;
    result.upper = length;
    result.overlap = simplex.size == 4;
  }
  if (!result.overlap && result.upper > 0.0) {
    const double rounding = kRounding * result.scale;
    const double unproved = 16.0 * rounding;
    const bool last = best_v.isZero(0.0) || along >= proved - rounding;
    const auto consider = [&](const Vec3& n, double least) {
      const double separation = -n.dot(support(n).w);
      if (separation < least) return;
      result.n = n, result.finished = true, result.lower = std::max(result.lower, separation);
    };
    if ((Finish::kRound || !last) && !result.finished)
      consider(finish(result.v / -result.upper, result.simplex.points.data(), result.simplex.size).n,
               result.lower - (Finish::kRound ? unproved : rounding));
    // Where v is so short that rounding turns it, what lies beyond its plane spans the right one with points
    // of the simplex, though it is not nearer to the origin than these by more than rounding.
    Simplex around = result.simplex;
    for (double before = -std::numeric_limits<double>::infinity();
         unproved < result.upper - result.lower && before < result.lower;) {
      const Vec3 n = result.finished ? result.n : Vec3(-(last ? result.v : best_v).normalized());
      const SupportPoint p = support(n);
      if (around.size == 4 || around.contains(p.w)) break;
      before = result.lower;
      around.add(p);
      consider(finish(n, around.points.data(), around.size).n, before + rounding);
      for (int i = 0; i + 1 < around.size; ++i)
        for (int j = 0; j < i; ++j) {
          const Vec3 across = (around.points[i].w - p.w).cross(around.points[j].w - p.w);
          if (const double length = across.norm(); length > 0.0)
            consider(std::copysign(1.0 / length, across.dot(n)) * across, result.lower + rounding);
        }
    }
    // A direction that does not prove the distance is not that of the nearest features.
    if (result.upper - result.lower > unproved) result.finished = false;
    // Where several points are nearest up to rounding, the last v may be wrong and an earlier one right.
    if (!result.finished) result.n = -(last ? result.v : best_v).normalized();
  }
  // Sets without a proof of separation overlap.
  if (!(result.lower > 0.0)) result.overlap = true;
  if (result.overlap) result.lower = 0.0;
  return result;
}

/// GJK that starts from the point of A - B farthest from `centre`, which is any point well inside A - B.
template <class Support, class Finish = NoFinish>
GjkResult gjk(const Support& support, const Vec3& centre, const Finish& finish = {},
              const Enough& enough = {}) {
  Simplex start;
  start.add(support(centre.isZero(0.0) ? Vec3(-Vec3::UnitX()) : Vec3(-centre)));
  return gjk(support, start, finish, enough);
}

}  // namespace rbs

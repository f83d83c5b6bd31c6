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

#include <algorithm>
#include <limits>

namespace rbs {

struct GjkResult {
  Vec3 v = Vec3::Zero();  ///< nearest point of A - B to the origin: witness of A minus witness of B
  double upper = 0.0;     ///< |v|: the distance, at most
  double lower = 0.0;     ///< the distance, at least; 0 where the sets overlap
  bool overlap = false;   ///< the origin is inside A - B, or nearer than rounding can tell
  double scale = 0.0;     ///< largest coordinate met, m: the unit of rounding
  int iterations = 0;     ///< kGjkIterations when it was cut off; the interval still holds
  Simplex simplex;        ///< last simplex, with the weights of v
};

inline constexpr int kGjkIterations = 128;

/// `support(d)` gives the SupportPoint of A - B farthest along d; `start` holds 1 to 4 points of A - B: any
/// will do, and those that an earlier call on nearly the same pair ended with save most of the work.
template <class Support>
GjkResult gjk(const Support& support, const Simplex& start) {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  constexpr int kStalls = 4;
  int stalls = 0;
  GjkResult result;
  const auto measure = [&](const SupportPoint& p) {
    result.scale = std::max({result.scale, p.a.cwiseAbs().maxCoeff(), p.b.cwiseAbs().maxCoeff()});
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
    const SupportPoint p = support(-result.v);
    measure(p);
    result.lower = std::max(result.lower, result.v.dot(p.w) / result.upper);
    if (result.upper - result.lower <= rounding || result.simplex.contains(p.w)) break;

    Simplex simplex = result.simplex;
    simplex.add(p);
    const Vec3 v = reduceToNearest(simplex);
    const double length = v.norm();
    // A step may leave v in place and still turn it, so that the next one gets on. One that rounding throws
    // back is not taken.
    if (simplex.size < 4 && !(length < result.upper) &&
        (++stalls > kStalls || length > result.upper + rounding))
      break;
    result.simplex = simplex;
    result.v = v;
    result.upper = length;
    result.overlap = simplex.size == 4;
  }
  // Sets that nothing proves apart overlap.
  if (!(result.lower > 0.0)) result.overlap = true;
  if (result.overlap) result.lower = 0.0;
  return result;
}

/// Likewise, from the point of A - B farthest from `centre`, which is any point well inside A - B.
template <class Support>
GjkResult gjk(const Support& support, const Vec3& centre) {
  Simplex start;
  start.add(support(centre.isZero(0.0) ? Vec3(-Vec3::UnitX()) : Vec3(-centre)));
  return gjk(support, start);
}

}  // namespace rbs

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

/// `support(d)` gives the SupportPoint of A - B farthest along d; `centre` is any point well inside A - B.
template <class Support>
GjkResult gjk(const Support& support, const Vec3& centre) {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  GjkResult result;
  const auto measure = [&](const SupportPoint& p) {
    result.scale = std::max({result.scale, p.a.cwiseAbs().maxCoeff(), p.b.cwiseAbs().maxCoeff()});
  };
  const SupportPoint first = support(centre.isZero(0.0) ? Vec3(-Vec3::UnitX()) : Vec3(-centre));
  measure(first);
  result.simplex.add(first);
  result.v = reduceToNearest(result.simplex);
  result.upper = result.v.norm();

  for (; result.iterations < kGjkIterations; ++result.iterations) {
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
    if (simplex.size < 4 && !(length < result.upper)) break;  // no progress: the last simplex stands
    result.simplex = simplex;
    result.v = v;
    result.upper = length;
    if (simplex.size == 4) {
      result.overlap = true;
      break;
    }
  }
  if (result.overlap) result.lower = 0.0;
  return result;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The penetration depth of two convex sets, and the direction of the shortest separation: the expanding
// polytope algorithm. G. van den Bergen, "Proximity queries and penetration depth computation on 3D game
// objects", GDC 2001.
#pragma once

#include "narrowphase/gjk.h"

#include <functional>

namespace rbs {

/// Gives the point of A - B farthest along a direction.
using SupportFunction = std::function<SupportPoint(const Vec3&)>;

/// Refines a direction, given points of the features that are near (finish.h).
using FinishFunction = std::function<Finished(const Vec3&, const SupportPoint*, int, Seek)>;

struct EpaResult {
  Vec3 n = Vec3::UnitZ();  ///< unit; moving B by `upper` along n separates A and B
  double upper = 0.0;      ///< upper bound of the depth; negative: n proves a gap
  double lower = 0.0;      ///< lower bound of the depth
  Vec3 a = Vec3::Zero();   ///< deepest point of A; a - b = upper n, up to upper - lower
  Vec3 b = Vec3::Zero();   ///< deepest point of B
  int iterations = 0;      ///< kEpaIterations when it was cut off; the bounds still hold
};

inline constexpr int kEpaIterations = 1024;

/// `simplex` (1 to 4 points of A - B) holds the origin or touches it, up to rounding; `scale` is the size
/// of the coordinates (GjkResult::scale), m. A flat A - B has depth 0 along its normal.
/// `finish`, where given, refines the direction.
EpaResult epa(const SupportFunction& support, const Simplex& simplex, double scale,
              const FinishFunction& finish = nullptr);

}  // namespace rbs

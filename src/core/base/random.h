// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine: integers, +, *, / and sqrt alone.
#pragma once

#include "rigid_body_sim/types.h"

#include <cmath>
#include <cstdint>

namespace rbs {

/// SplitMix64 of Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (OOPSLA 2014):
/// a counter that steps by the odd number nearest to 2^64 / golden ratio, and a mixing function.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : counter_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = counter_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1): the upper 53 bits, as many as a double holds.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in 0 ... n-1; the bias of the remainder is below n / 2^64.
  std::uint64_t below(std::uint64_t n) { return next() % n; }
  /// A generator whose numbers are independent of the further numbers of this one.
  SplitMix64 split() { return SplitMix64(next()); }

 private:
  std::uint64_t counter_;
};

/// An orientation drawn evenly from all orientations, as a unit quaternion: Marsaglia's point on the
/// 3-sphere ("Choosing a point from the surface of a sphere", Ann. Math. Stat. 1972). With (a, b) and
/// (c, d) even in the unit disc, s = a² + b² and t = c² + d², it is (a, b, c f, d f), f = sqrt((1-s)/t).
inline Quat randomAttitude(SplitMix64& random) {
  const auto pointInDisc = [&random] {
    Eigen::Vector2d p;
    do {
      p.x() = random.uniform(-1.0, 1.0);
      p.y() = random.uniform(-1.0, 1.0);
    } while (p.squaredNorm() >= 1.0 || p.isZero(0.0));
    return p;
  };
  const Eigen::Vector2d p = pointInDisc();
  const Eigen::Vector2d q = pointInDisc();
  const double f = std::sqrt((1.0 - p.squaredNorm()) / q.squaredNorm());
  return Quat(q.y() * f, p.x(), p.y(), q.x() * f);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Tolerances that several routines of the narrow phase share; docs/tolerances.md has all of them.
#pragma once

#include <limits>

namespace rbs {

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// What a few operations lose, as a share of the largest number in them.
inline constexpr double kRounding = 4.0 * kEpsilon;
/// What the chain of operations behind a face or a cut loses, as the same share.
inline constexpr double kChainRounding = 16.0 * kEpsilon;
/// Square of the sine of an angle below which directions are nearly parallel: their cross product has lost
/// digits.
inline constexpr double kParallel = 1e-2;
/// A face is met flat when the cosine of its angle to the normal is within this of 1 (2.6 degrees).
inline constexpr double kAligned = 1e-3;
/// How far a point may overhang the other face, as a share of its size, before it is clipped: equal faces on
/// each other keep their corners.
inline constexpr double kOverhang = 1e-5;
/// A corner within this share of the size of the depth stands for the deepest point.
inline constexpr double kCovers = 1e-6;

}  // namespace rbs

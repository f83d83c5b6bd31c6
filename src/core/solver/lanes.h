// SPDX-License-Identifier: BSD-3-Clause
// Four numbers at a time, and arithmetic on them, for the loops over contacts.
#pragma once

#include "base/wide.h"
#include "solver/solver_contacts.h"

#include <array>

namespace rbs {

/// One number of each of four pairs. Arithmetic goes number by number and rounds as if each were alone.
using Lanes = double __attribute__((vector_size(32), aligned(32)));
/// What a comparison of them gives: for each all bits or none.
using LaneMask = decltype(Lanes{} > Lanes{});
inline constexpr int kLanes = 4;

}  // namespace rbs

namespace rbs::lanes {

RBS_INLINE void fill(Lanes& to, double value) {
  to = Lanes{value, value, value, value};
}

RBS_INLINE void set(Lanes* to, int lane, const Vec3& from) {
  for (int c = 0; c < 3; ++c) to[c][lane] = from[c];
}

RBS_INLINE void gather(const std::array<SolverBody*, kLanes>& from, Vec3 SolverBody::*what, Lanes* to) {
  const Vec3 &a = from[0]->*what, &b = from[1]->*what, &c = from[2]->*what, &d = from[3]->*what;
  to[0] = Lanes{a.x(), b.x(), c.x(), d.x()};
  to[1] = Lanes{a.y(), b.y(), c.y(), d.y()};
  to[2] = Lanes{a.z(), b.z(), c.z(), d.z()};
}

RBS_INLINE void scatter(const Lanes* from, Vec3 SolverBody::*what,
                        const std::array<SolverBody*, kLanes>& to) {
  for (int k = 0; k < kLanes; ++k)
    for (int c = 0; c < 3; ++c) (to[k]->*what)[c] = from[c][k];
}

RBS_INLINE void dot(const Lanes* a, const Lanes* b, Lanes& result) {
  result = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// c + a . b in as few sums one after another as can be: passes wait for it.
RBS_INLINE void add6(const Lanes& c, const Lanes* a, const Lanes* b, Lanes& result) {
  result = ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + ((a[4] * b[4] + a[5] * b[5]) + c);
}

RBS_INLINE void cross(const Lanes* a, const Lanes* b, Lanes* result) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

template <class Mask>
RBS_INLINE bool any(const Mask& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}

}  // namespace rbs::lanes

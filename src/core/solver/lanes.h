// SPDX-License-Identifier: BSD-3-Clause
// Four numbers at a time, and arithmetic on them, for the loops over contacts.
#pragma once

#include "base/wide.h"
#include "solver/solver_contacts.h"

#include <array>
#include <cstddef>

namespace rbs {

/// One number of each of four pairs. Arithmetic goes number by number and rounds as if each were alone.
using Lanes = double __attribute__((vector_size(32), aligned(32)));
/// What a comparison of them gives: for each all bits or none.
using LaneMask = decltype(Lanes{} > Lanes{});
inline constexpr int kLanes = 4;
/// Two numbers that lie beside each other in a body.
using TwoLanes = double __attribute__((vector_size(16)));
static_assert(offsetof(SolverBody, w) == offsetof(SolverBody, v) + sizeof(Vec3));

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

// Velocities and spins, which lie one after the other, two numbers at a time.
RBS_INLINE void gatherTwists(const std::array<SolverBody*, kLanes>& from, Lanes* v, Lanes* w) {
  Lanes* const to[6] = {v, v + 1, v + 2, w, w + 1, w + 2};
  for (int k = 0; k < 6; k += 2) {
    const auto two = [&](int lane) __attribute__((always_inline)) {
      TwoLanes both;
      __builtin_memcpy(&both, from[lane]->v.data() + k, sizeof both);
      return both;
    };
    const Lanes even = __builtin_shufflevector(two(0), two(2), 0, 1, 2, 3);
    const Lanes odd = __builtin_shufflevector(two(1), two(3), 0, 1, 2, 3);
    *to[k] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    *to[k + 1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
  }
}

RBS_INLINE void scatterTwists(const Lanes* v, const Lanes* w, const std::array<SolverBody*, kLanes>& to) {
  const Lanes* const from[6] = {v, v + 1, v + 2, w, w + 1, w + 2};
  for (int k = 0; k < 6; k += 2) {
    const auto write = [&](int lane, TwoLanes both) __attribute__((always_inline)) {
      __builtin_memcpy(to[lane]->v.data() + k, &both, sizeof both);
    };
    const Lanes even = __builtin_shufflevector(*from[k], *from[k + 1], 0, 4, 2, 6);
    const Lanes odd = __builtin_shufflevector(*from[k], *from[k + 1], 1, 5, 3, 7);
    write(0, __builtin_shufflevector(even, even, 0, 1));
    write(1, __builtin_shufflevector(odd, odd, 0, 1));
    write(2, __builtin_shufflevector(even, even, 2, 3));
    write(3, __builtin_shufflevector(odd, odd, 2, 3));
  }
}

RBS_INLINE void dot(const Lanes* a, const Lanes* b, Lanes& result) {
  result = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RBS_INLINE void cross(const Lanes* a, const Lanes* b, Lanes* result) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

// To a frame, of these three axes, and back.
RBS_INLINE void toFrame(const Lanes (*axes)[3], const Lanes* from, Lanes* to) {
  for (int c = 0; c < 3; ++c) dot(axes[c], from, to[c]);
}

RBS_INLINE void fromFrame(const Lanes (*axes)[3], const Lanes* from, Lanes* to) {
  for (int c = 0; c < 3; ++c) to[c] = from[0] * axes[0][c] + from[1] * axes[1][c] + from[2] * axes[2][c];
}

// A symmetric matrix, of elements 00, 01, 02, 11, 12 and 22, times a vector.
RBS_INLINE void turn(const Lanes* matrix, const Lanes* a, Lanes* result) {
  result[0] = matrix[0] * a[0] + matrix[1] * a[1] + matrix[2] * a[2];
  result[1] = matrix[1] * a[0] + matrix[3] * a[1] + matrix[4] * a[2];
  result[2] = matrix[2] * a[0] + matrix[4] * a[1] + matrix[5] * a[2];
}

// The same of a vector (0, a_1, a_2).
RBS_INLINE void turnAcross(const Lanes* matrix, const Lanes& a1, const Lanes& a2, Lanes* result) {
  result[0] = matrix[1] * a1 + matrix[2] * a2;
  result[1] = matrix[3] * a1 + matrix[4] * a2;
  result[2] = matrix[4] * a1 + matrix[5] * a2;
}

// Leaves out of a vector what is along an axis of length 1; one of zeros leaves it as it is.
RBS_INLINE void leaveOut(const Lanes* axis, Lanes* a) {
  Lanes along;
  dot(axis, a, along);
  for (int c = 0; c < 3; ++c) a[c] -= along * axis[c];
}

// The same of a symmetric matrix as turn() takes it, on both of its sides: P M P, with P = 1 - a a^T.
RBS_INLINE void leaveOutOfMatrix(const Lanes* axis, Lanes* matrix) {
  Lanes by[3], along;  // M a, a.M a
  turn(matrix, axis, by);
  dot(axis, by, along);
  for (int c = 0, at = 0; c < 3; ++c)
    for (int d = c; d < 3; ++d, ++at)
      matrix[at] -= by[c] * axis[d] + axis[c] * by[d] - along * axis[c] * axis[d];
}

template <class Mask>
RBS_INLINE bool any(const Mask& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}

}  // namespace rbs::lanes

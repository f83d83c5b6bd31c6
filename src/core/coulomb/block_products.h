// SPDX-License-Identifier: BSD-3-Clause
// Products of 6x6 blocks, and of 3x3, for functions that are RBS_WIDE: Eigen has chosen its registers when it is compiled, and
// takes two numbers at a time.
//
// A column of six is a vector of four and one of two. One of three is a vector of four, the last of which is 0. Sums of six
// go in the order of Eigen's, so that they have the same bits.
#pragma once

#include "base/wide.h"
#include "coulomb/coulomb_system.h"

#include <cstring>

namespace rbs::coulomb::block {

using Four = double __attribute__((vector_size(32)));
using Two = double __attribute__((vector_size(16)));

template <int n>
struct Column;

template <>
struct Column<6> {
  Four head;
  Two tail;
};

template <>
struct Column<3> {
  Four head;
};

/// Numbers from one column of a stored block to the next.
template <int n>
inline constexpr int kStride = n == 3 ? 4 : n;

/// A block as it is stored.
template <int n>
using Block = Eigen::Matrix<double, kStride<n>, n>;

RBS_INLINE void load(const double* from, Column<6>& to) {
  std::memcpy(&to.head, from, sizeof to.head);
  std::memcpy(&to.tail, from + 4, sizeof to.tail);
}
RBS_INLINE void load(const double* from, Column<3>& to) {
  std::memcpy(&to.head, from, sizeof to.head);
}

RBS_INLINE void store(const Column<6>& from, double* to) {
  std::memcpy(to, &from.head, sizeof from.head);
  std::memcpy(to + 4, &from.tail, sizeof from.tail);
}
RBS_INLINE void store(const Column<3>& from, double* to) {
  std::memcpy(to, &from.head, sizeof from.head);
}

/// y = a x. The two may be one.
RBS_INLINE void times(const Column<6>& x, double a, Column<6>& y) {
  y.head = x.head * a, y.tail = x.tail * a;
}
RBS_INLINE void times(const Column<3>& x, double a, Column<3>& y) {
  y.head = x.head * a;
}

/// y += a x.
RBS_INLINE void add(const Column<6>& x, double a, Column<6>& y) {
  y.head += x.head * a, y.tail += x.tail * a;
}
RBS_INLINE void add(const Column<3>& x, double a, Column<3>& y) {
  y.head += x.head * a;
}

/// y -= a x.
RBS_INLINE void subtract(const Column<6>& x, double a, Column<6>& y) {
  y.head -= x.head * a, y.tail -= x.tail * a;
}
RBS_INLINE void subtract(const Column<3>& x, double a, Column<3>& y) {
  y.head -= x.head * a;
}

template <int n>
RBS_INLINE void subtract(const Column<n>& x, double a, double* y) {
  Column<n> rest;
  load(y, rest);
  subtract(x, a, rest);
  store(rest, y);
}

/// Divides what is below row k by the number in that row. `below` is that part, with zeros above.
RBS_INLINE void divideBelow(int k, Column<6>& column, Column<6>& below) {
  const double pivot = k < 4 ? column.head[k] : column.tail[k - 4];
  using Bits = decltype(column.head < column.head);
  using TwoBits = decltype(column.tail < column.tail);
  const Bits head = Bits{0, 1, 2, 3} > k;
  const TwoBits tail = TwoBits{4, 5} > k;
  below.head = head ? column.head / pivot : Four{}, below.tail = tail ? column.tail / pivot : Two{};
  column.head = head ? below.head : column.head, column.tail = tail ? below.tail : column.tail;
}

template <int n>
struct Columns {
  Column<n> of[n];
};

template <int n>
RBS_INLINE void load(const Block<n>& from, Columns<n>& to) {
#pragma GCC unroll 6
  for (int k = 0; k < n; ++k) load(from.data() + kStride<n> * k, to.of[k]);
}

/// sum = A x, for n numbers x.
template <int n>
RBS_INLINE void times(const Columns<n>& A, const double* x, Column<n>& sum) {
  times(A.of[0], x[0], sum);
#pragma GCC unroll 5
  for (int k = 1; k < n; ++k) add(A.of[k], x[k], sum);
}

/// y -= A x.
template <int n>
RBS_INLINE void subtract(const Columns<n>& A, const double* x, double* y) {
  Column<n> sum;
  times(A, x, sum);
  subtract(sum, 1.0, y);
}

/// C -= A B.
template <int n>
RBS_INLINE void subtract(const Columns<n>& A, const Block<n>& B, Block<n>& C) {
  for (int c = 0; c < n; ++c) subtract(A, B.data() + kStride<n> * c, C.data() + kStride<n> * c);
}

/// A B, in the place of A.
template <int n>
RBS_INLINE void multiply(Block<n>& A, const Block<n>& B) {
  Columns<n> columns;
  load<n>(A, columns);
  for (int c = 0; c < n; ++c) {
    Column<n> sum;
    times(columns, B.data() + kStride<n> * c, sum);
    store(sum, A.data() + kStride<n> * c);
  }
}

/// C += J^T E, of the first n columns of the two.
RBS_INLINE void addTransposed(const Mat36& J, const Mat36& E, Block<6>& C) {
  Column<6> rows[3];
  for (int r = 0; r < 3; ++r) {
    const double* j = J.data() + r;
    rows[r].head = Four{j[0], j[3], j[6], j[9]}, rows[r].tail = Two{j[12], j[15]};
  }
  for (int c = 0; c < 6; ++c) {
    const double* e = E.data() + 3 * c;
    Column<6> sum;
    load(C.data() + 6 * c, sum);
    sum.head += (rows[0].head * e[0] + rows[1].head * e[1]) + rows[2].head * e[2];
    sum.tail += (rows[0].tail * e[0] + rows[1].tail * e[1]) + rows[2].tail * e[2];
    store(sum, C.data() + 6 * c);
  }
}
RBS_INLINE void addTransposed(const Mat36& J, const Mat36& E, Block<3>& C) {
  Column<3> rows[3];
  for (int r = 0; r < 3; ++r) rows[r].head = Four{J(r, 0), J(r, 1), J(r, 2), 0.0};
  for (int c = 0; c < 3; ++c) {
    const double* e = E.data() + 3 * c;
    Column<3> sum;
    load(C.data() + 4 * c, sum);
    sum.head += (rows[0].head * e[0] + rows[1].head * e[1]) + rows[2].head * e[2];
    store(sum, C.data() + 4 * c);
  }
}

}  // namespace rbs::coulomb::block

// SPDX-License-Identifier: BSD-3-Clause
// Products of 6x6 blocks, for functions that are RBS_WIDE: Eigen has chosen its registers when it is compiled, and takes
// two numbers at a time.
//
// A column of six is a vector of four and one of two. Sums go in the order of Eigen's, so that they have the same bits.
#pragma once

#include "base/wide.h"
#include "coulomb/coulomb_system.h"

#include <cstring>

namespace rbs::coulomb::block {

using Four = double __attribute__((vector_size(32)));
using Two = double __attribute__((vector_size(16)));

struct Column {
  Four head;
  Two tail;
};

RBS_INLINE void load(const double* from, Column& to) {
  std::memcpy(&to.head, from, sizeof to.head);
  std::memcpy(&to.tail, from + 4, sizeof to.tail);
}

RBS_INLINE void store(const Column& from, double* to) {
  std::memcpy(to, &from.head, sizeof from.head);
  std::memcpy(to + 4, &from.tail, sizeof from.tail);
}

/// y = a x. The two may be one.
RBS_INLINE void times(const Column& x, double a, Column& y) {
  y.head = x.head * a, y.tail = x.tail * a;
}

/// y += a x.
RBS_INLINE void add(const Column& x, double a, Column& y) {
  y.head += x.head * a, y.tail += x.tail * a;
}

/// y -= a x.
RBS_INLINE void subtract(const Column& x, double a, Column& y) {
  y.head -= x.head * a, y.tail -= x.tail * a;
}

RBS_INLINE void subtract(const Column& x, double a, double* y) {
  Column rest;
  load(y, rest);
  subtract(x, a, rest);
  store(rest, y);
}

/// Divides what is below row k by the number in that row. `below` is that part, with zeros above.
RBS_INLINE void divideBelow(int k, Column& column, Column& below) {
  const double pivot = k < 4 ? column.head[k] : column.tail[k - 4];
  using Bits = decltype(column.head < column.head);
  using TwoBits = decltype(column.tail < column.tail);
  const Bits head = Bits{0, 1, 2, 3} > k;
  const TwoBits tail = TwoBits{4, 5} > k;
  below.head = head ? column.head / pivot : Four{}, below.tail = tail ? column.tail / pivot : Two{};
  column.head = head ? below.head : column.head, column.tail = tail ? below.tail : column.tail;
}

struct Columns {
  Column of[6];
};

RBS_INLINE void load(const Mat6& from, Columns& to) {
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) load(from.data() + 6 * k, to.of[k]);
}

/// sum = A x, for six numbers x.
RBS_INLINE void times(const Columns& A, const double* x, Column& sum) {
  times(A.of[0], x[0], sum);
#pragma GCC unroll 5
  for (int k = 1; k < 6; ++k) add(A.of[k], x[k], sum);
}

/// y -= A x.
RBS_INLINE void subtract(const Columns& A, const double* x, double* y) {
  Column sum, rest;
  times(A, x, sum);
  load(y, rest);
  rest.head -= sum.head, rest.tail -= sum.tail;
  store(rest, y);
}

/// C -= A B.
RBS_INLINE void subtract(const Columns& A, const Mat6& B, Mat6& C) {
  for (int c = 0; c < 6; ++c) subtract(A, B.data() + 6 * c, C.data() + 6 * c);
}

/// A B, in the place of A.
RBS_INLINE void multiply(Mat6& A, const Mat6& B) {
  Columns columns;
  load(A, columns);
  for (int c = 0; c < 6; ++c) {
    Column sum;
    times(columns, B.data() + 6 * c, sum);
    store(sum, A.data() + 6 * c);
  }
}

/// C += J^T E.
RBS_INLINE void addTransposed(const Mat36& J, const Mat36& E, Mat6& C) {
  Column rows[3];
  for (int r = 0; r < 3; ++r) {
    const double* j = J.data() + r;
    rows[r].head = Four{j[0], j[3], j[6], j[9]}, rows[r].tail = Two{j[12], j[15]};
  }
  for (int c = 0; c < 6; ++c) {
    const double* e = E.data() + 3 * c;
    Column sum;
    load(C.data() + 6 * c, sum);
    sum.head += (rows[0].head * e[0] + rows[1].head * e[1]) + rows[2].head * e[2];
    sum.tail += (rows[0].tail * e[0] + rows[1].tail * e[1]) + rows[2].tail * e[2];
    store(sum, C.data() + 6 * c);
  }
}

}  // namespace rbs::coulomb::block

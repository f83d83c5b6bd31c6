// SPDX-License-Identifier: BSD-3-Clause
// The matrix 1 + J^T D J of an island, with 6x6 blocks, a row and a column a body; and its LU factors. Blocks are 3x3 where
// impulses turn no body, as with balls without friction.
//
// D has a 3x3 block a point and a joint, so that blocks stand on the diagonal and where two bodies touch or are joined. A
// torque constraint has one of its own, and a column g by the normal rows of the points of its pair: blocks stand where they stand
// already.
//
// Bodies are eliminated in the order of least degree (Tinney and Walker 1967; George and Liu 1989): at each
// step the one tied to the fewest that are left, the first of them where several are; eliminating it ties all
// its neighbours to each other. That is found once, on the graph; the blocks that fill in are the same
// whatever D.
//
// With the bodies in that order, and n(k) the later neighbours of k, a step of the elimination is
//   T_a = A_ak A_kk^-1,   A_ab -= T_a A_kb   for a, b in n(k).
// A_kk is factored with row exchanges inside the block. None are made between blocks: D is positive, or
// nearly.
#pragma once

#include "coulomb/block_products.h"
#include "coulomb/coulomb_system.h"

#include <cstdint>
#include <variant>
#include <vector>

namespace rbs::coulomb {

class BodyBlocks {
 public:
  explicit BodyBlocks(const System& system);

  /// Factors 1 + J^T D J, D by column of impulses, with g by torque. False where a block on the diagonal is
  /// singular or not finite. What it costs is taken from the budget of the system, and so is that of solve().
  bool factor(const std::vector<Mat3>& D, const std::vector<Vec3>& g);
  /// (1 + J^T D J)^-1 y, from the factors.
  Velocities solve(const Velocities& y) const;

 private:
  void order();
  /// Where the pair of bodies is in rows_; 0 where one of the two is none.
  std::uint32_t slotOf(const Rows& rows) const;
  template <int n>
  struct Blocks {
    std::vector<block::Block<n>> diagonal;      // A_kk, then its inverse
    std::vector<block::Block<n>> lower, upper;  // A_ak, then T_a; and A_ka
  };
  template <int n>
  void assemble(const std::vector<Mat3>& D, const std::vector<Vec3>& g, Blocks<n>& blocks) const;
  template <int n>
  bool factor(const std::vector<Mat3>& D, const std::vector<Vec3>& g, Blocks<n>& blocks) const;
  template <int n>
  Velocities solve(const Velocities& y, const Blocks<n>& blocks) const;
  template <int n>
  void substitute(const Blocks<n>& blocks, double* x) const;
  /// Adds J^T DJ.
  template <int n>
  void addBlocks(const Rows& rows, const Mat36& DJ_i, const Mat36& DJ_j, std::uint32_t slot,
                 Blocks<n>& blocks) const;

  const System& system_;
  std::vector<Index> order_, place_;               // body by place in the order, and the inverse
  std::vector<std::uint32_t> begin_;               // by place: the start of its part of rows_, lower_, upper_
  std::vector<Index> rows_;                        // places of the later neighbours, ascending
  std::vector<std::uint32_t> slot_;                // by point, then by joint: where its pair is in rows_
  std::int64_t factor_work_ = 0, solve_work_ = 0;  // multiplications
  std::variant<Blocks<3>, Blocks<6>> blocks_;
};

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/body_blocks.h"

#include "coulomb/block_products.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace rbs::coulomb {

namespace {

// Multiplications by point in an iteration that factors: its blocks, and what the method does at each point.
constexpr std::int64_t kPointWork = 2000;

// The inverse, by Gauss with partial pivoting; not finite where there is none. Eigen's own is made for large
// matrices, and costs many times as much. The order of the sums is the same: rows are solved for in groups of four
// and two.
RBS_INLINE Mat6 inverseOf(Mat6 A) {
  using Column = block::Column<6>;
  const Mat6 identity = Mat6::Identity();
  Column X[6];  // rows
  for (int k = 0; k < 6; ++k) block::load(identity.col(k).data(), X[k]);
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    int pivot = k;
    for (int row = k + 1; row < 6; ++row)
      if (std::abs(A(row, k)) > std::abs(A(pivot, k))) pivot = row;
    if (pivot != k) A.row(k).swap(A.row(pivot)), std::swap(X[k], X[pivot]);
    Column column, factors;
    block::load(A.col(k).data(), column);
    block::divideBelow(k, column, factors);
    block::store(column, A.col(k).data());
#pragma GCC unroll 6
    for (int c = k + 1; c < 6; ++c) block::subtract(factors, A(k, c), A.col(c).data());
  }
  const auto takeOff = [&](int row, int first) {  // four unknowns at once
    Column sum;
    block::times(X[first], A(row, first), sum);
    for (int k = first + 1; k < first + 4; ++k) block::add(X[k], A(row, k), sum);
    block::subtract(sum, 1.0, X[row]);
  };
  for (int k = 0; k < 3; ++k)
    for (int row = k + 1; row < 4; ++row) block::subtract(X[k], A(row, k), X[row]);
  takeOff(4, 0), takeOff(5, 0);
  block::subtract(X[4], A(5, 4), X[5]);
  for (int k = 5; k >= 0; --k) {
    if (k == 1) takeOff(0, 2), takeOff(1, 2);
    block::times(X[k], 1.0 / A(k, k), X[k]);
    for (int row = k < 2 ? 0 : 2; row < k; ++row) block::subtract(X[k], A(row, k), X[row]);
  }
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> inverse;
  for (int k = 0; k < 6; ++k) block::store(X[k], inverse.row(k).data());
  return inverse;
}

RBS_INLINE block::Block<3> inverseOf(block::Block<3> A) {
  block::Block<3> X = block::Block<3>::Identity();
  for (int k = 0; k < 3; ++k) {
    int pivot = k;
    for (int row = k + 1; row < 3; ++row)
      if (std::abs(A(row, k)) > std::abs(A(pivot, k))) pivot = row;
    if (pivot != k) A.row(k).swap(A.row(pivot)), X.row(k).swap(X.row(pivot));
    const double scale = 1.0 / A(k, k);
    A.row(k) *= scale, X.row(k) *= scale;
    for (int row = 0; row < 3; ++row) {
      if (row == k) continue;
      const double factor = A(row, k);
      A.row(row) -= factor * A.row(k), X.row(row) -= factor * X.row(k);
    }
  }
  return X;
}

}  // namespace

BodyBlocks::BodyBlocks(const System& system) : system_(system) {
  order();
  if (system.turns()) blocks_.emplace<Blocks<6>>();
  std::visit(
      [this](auto& blocks) {
        blocks.diagonal.resize(order_.size());
        blocks.lower.resize(rows_.size());
        blocks.upper.resize(rows_.size());
      },
      blocks_);
  for (const Point& point : system_.points()) slot_.push_back(slotOf(point));
  for (const JointRows& joint : system_.joints()) slot_.push_back(slotOf(joint));
  const std::int64_t n = system.turns() ? 6 : 3;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const std::int64_t later = begin_[k + 1] - begin_[k];
    factor_work_ += n * n * n * (1 + later + later * later);
    solve_work_ += n * n * (1 + 2 * later);
  }
  factor_work_ += kPointWork * static_cast<std::int64_t>(system.columns());
}

std::uint32_t BodyBlocks::slotOf(const Rows& rows) const {
  if (rows.i == kNone || rows.j == kNone) return 0;
  const auto [first, second] = std::minmax(place_[rows.i], place_[rows.j]);
  const auto begin = rows_.begin() + begin_[first], end = rows_.begin() + begin_[first + 1];
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, second) - rows_.begin());
}

void BodyBlocks::order() {
  const Index bodies = static_cast<Index>(system_.free().cols());
  std::vector<std::vector<Index>> neighbours(bodies);
  const auto tie = [&](const Rows& rows) {
    if (rows.i == kNone || rows.j == kNone) return;
    neighbours[rows.i].push_back(rows.j);
    neighbours[rows.j].push_back(rows.i);
  };
  for (const Point& point : system_.points()) tie(point);
  for (const JointRows& joint : system_.joints()) tie(joint);
  std::set<std::pair<std::size_t, Index>> by_degree;
  for (Index body = 0; body < bodies; ++body) {
    std::vector<Index>& n = neighbours[body];
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
    by_degree.insert({n.size(), body});
  }
  place_.assign(bodies, kNone);
  std::vector<Index> merged;
  while (!by_degree.empty()) {
    const Index body = by_degree.begin()->second;
    by_degree.erase(by_degree.begin());
    place_[body] = static_cast<Index>(order_.size());
    order_.push_back(body);
    const std::vector<Index>& clique = neighbours[body];
    for (const Index other : clique) {
      std::vector<Index>& n = neighbours[other];
      by_degree.erase({n.size(), other});
      merged.clear();
      std::set_union(n.begin(), n.end(), clique.begin(), clique.end(), std::back_inserter(merged));
      const auto is_gone = [&](Index k) { return k == body || k == other; };
      merged.erase(std::remove_if(merged.begin(), merged.end(), is_gone), merged.end());
      n = merged;
      by_degree.insert({n.size(), other});
    }
  }
  // The neighbours left to each body are those that come after it.
  begin_.push_back(0);
  for (const Index body : order_) {
    for (const Index other : neighbours[body]) rows_.push_back(place_[other]);
    std::sort(rows_.begin() + begin_.back(), rows_.end());
    begin_.push_back(static_cast<std::uint32_t>(rows_.size()));
  }
}

template <int n>
RBS_INLINE void BodyBlocks::addBlocks(const Rows& rows, const Mat36& DJ_i, const Mat36& DJ_j,
                                      std::uint32_t slot, Blocks<n>& blocks) const {
  using block::addTransposed;
  if (rows.i != kNone) addTransposed(rows.J_i, DJ_i, blocks.diagonal[place_[rows.i]]);
  if (rows.j != kNone) addTransposed(rows.J_j, DJ_j, blocks.diagonal[place_[rows.j]]);
  if (rows.i == kNone || rows.j == kNone) return;
  const bool i_first = place_[rows.i] < place_[rows.j];
  addTransposed(rows.J_j, DJ_i, i_first ? blocks.lower[slot] : blocks.upper[slot]);
  addTransposed(rows.J_i, DJ_j, i_first ? blocks.upper[slot] : blocks.lower[slot]);
}

template <int n>
RBS_WIDE void BodyBlocks::assemble(const std::vector<Mat3>& D, const std::vector<Vec3>& g,
                                   Blocks<n>& blocks) const {
  for (auto& block : blocks.diagonal) block.setIdentity();
  for (auto& block : blocks.lower) block.setZero();
  for (auto& block : blocks.upper) block.setZero();
  const std::vector<Point>& points = system_.points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    addBlocks(points[k], D[k] * points[k].J_i, D[k] * points[k].J_j, slot_[k], blocks);
  }
  for (std::size_t k = 0; k < g.size(); ++k) {
    const TorqueRows& torque = system_.torques()[k];
    Vec6 n_i = Vec6::Zero(), n_j = Vec6::Zero();
    for (std::size_t p = torque.first; p < torque.first + torque.size; ++p) {
      n_i += D[p](2, 2) * points[p].J_i.row(2).transpose();
      n_j += D[p](2, 2) * points[p].J_j.row(2).transpose();
    }
    Mat36 DJ_i = g[k] * n_i.transpose(), DJ_j = g[k] * n_j.transpose();
    DJ_i.rightCols<3>() += D[points.size() + k] * torque.J_i.rightCols<3>();
    DJ_j.rightCols<3>() += D[points.size() + k] * torque.J_j.rightCols<3>();
    addBlocks(torque, DJ_i, DJ_j, slot_[torque.first], blocks);
  }
  for (std::size_t k = 0; k < system_.joints().size(); ++k) {
    const JointRows& joint = system_.joints()[k];
    const Mat3& D_k = D[system_.firstJoint() + k];
    addBlocks(joint, D_k * joint.J_i, D_k * joint.J_j, slot_[points.size() + k], blocks);
  }
}

template <int n>
RBS_WIDE bool BodyBlocks::factor(const std::vector<Mat3>& D, const std::vector<Vec3>& g,
                                 Blocks<n>& blocks) const {
  auto& [diagonal, lower, upper] = blocks;
  assemble(D, g, blocks);
  for (std::size_t k = 0; k < diagonal.size(); ++k) {
    const block::Block<n> inverse = inverseOf(diagonal[k]);
    if (!inverse.allFinite()) return false;
    diagonal[k] = inverse;
    const std::uint32_t begin = begin_[k], end = begin_[k + 1];
    for (std::uint32_t a = begin; a < end; ++a) block::multiply<n>(lower[a], inverse);
    for (std::uint32_t a = begin; a < end; ++a) {
      const Index row = rows_[a];
      block::Columns<n> T_a, T_b;
      block::load<n>(lower[a], T_a);
      block::subtract<n>(T_a, upper[a], diagonal[row]);
      std::uint32_t target = begin_[row];
      for (std::uint32_t b = a + 1; b < end; ++b) {
        while (rows_[target] != rows_[b]) ++target;
        block::load<n>(lower[b], T_b);
        block::subtract<n>(T_b, upper[a], lower[target]);
        block::subtract<n>(T_a, upper[b], upper[target]);
      }
    }
  }
  return true;
}

bool BodyBlocks::factor(const std::vector<Mat3>& D, const std::vector<Vec3>& g) {
  system_.spend(factor_work_);
  return std::visit([&](auto& blocks) { return factor(D, g, blocks); }, blocks_);
}

// With x by place, a column of a block each.
template <int n>
RBS_WIDE void BodyBlocks::substitute(const Blocks<n>& blocks, double* x) const {
  constexpr int kStride = block::kStride<n>;
  block::Columns<n> columns;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    for (std::uint32_t a = begin_[k]; a < begin_[k + 1]; ++a) {
      block::load<n>(blocks.lower[a], columns);
      block::subtract(columns, x + kStride * k, x + kStride * rows_[a]);
    }
  }
  for (std::size_t k = order_.size(); k-- > 0;) {
    for (std::uint32_t a = begin_[k]; a < begin_[k + 1]; ++a) {
      block::load<n>(blocks.upper[a], columns);
      block::subtract(columns, x + kStride * rows_[a], x + kStride * k);
    }
    block::Column<n> product;
    block::load<n>(blocks.diagonal[k], columns);
    block::times(columns, x + kStride * k, product);
    block::store(product, x + kStride * k);
  }
}

template <int n>
Velocities BodyBlocks::solve(const Velocities& y, const Blocks<n>& blocks) const {
  constexpr int kStride = block::kStride<n>;
  Eigen::Matrix<double, kStride, Eigen::Dynamic> x(kStride, y.cols());
  if (kStride > n) x.bottomRows(kStride - n).setZero();
  for (std::size_t k = 0; k < order_.size(); ++k) x.col(k).template head<n>() = y.col(order_[k]).head<n>();
  substitute(blocks, x.data());
  Velocities result = y;  // the angular part of what does not turn stays as it is
  for (std::size_t k = 0; k < order_.size(); ++k)
    result.col(order_[k]).head<n>() = x.col(k).template head<n>();
  return result;
}

Velocities BodyBlocks::solve(const Velocities& y) const {
  system_.spend(solve_work_);
  return std::visit([&](const auto& blocks) { return solve(y, blocks); }, blocks_);
}

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/body_blocks.h"

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
// matrices, and four times as dear. The order of the sums is the same: rows are solved for in groups of four
// and two.
Mat6 inverseOf(Mat6 A) {
  using Rows = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  Rows X = Rows::Identity();
  for (int k = 0; k < 6; ++k) {
    int pivot = k;
    for (int row = k + 1; row < 6; ++row)
      if (std::abs(A(row, k)) > std::abs(A(pivot, k))) pivot = row;
    if (pivot != k) A.row(k).swap(A.row(pivot)), X.row(k).swap(X.row(pivot));
    for (int row = k + 1; row < 6; ++row) A(row, k) /= A(k, k);
    for (int column = k + 1; column < 6; ++column)
      for (int row = k + 1; row < 6; ++row) A(row, column) -= A(row, k) * A(k, column);
  }
  const auto takeOff = [&](int row, int first) {  // four unknowns at once
    X.row(row) -= (A(row, first) * X.row(first) + A(row, first + 1) * X.row(first + 1) +
                   A(row, first + 2) * X.row(first + 2) + A(row, first + 3) * X.row(first + 3))
                      .eval();
  };
  for (int k = 0; k < 3; ++k)
    for (int row = k + 1; row < 4; ++row) X.row(row) -= A(row, k) * X.row(k);
  takeOff(4, 0), takeOff(5, 0);
  X.row(5) -= A(5, 4) * X.row(4);
  for (int k = 5; k >= 0; --k) {
    if (k == 1) takeOff(0, 2), takeOff(1, 2);
    X.row(k) *= 1.0 / A(k, k);
    for (int row = k < 2 ? 0 : 2; row < k; ++row) X.row(row) -= A(row, k) * X.row(k);
  }
  return X;
}

}  // namespace

BodyBlocks::BodyBlocks(const System& system) : system_(system) {
  order();
  diagonal_.resize(order_.size());
  lower_.resize(rows_.size());
  upper_.resize(rows_.size());
  for (const Point& point : system_.points()) {
    std::uint32_t slot = 0;
    if (point.i != kNone && point.j != kNone) {
      const Index first = std::min(place_[point.i], place_[point.j]);
      const Index second = std::max(place_[point.i], place_[point.j]);
      const auto begin = rows_.begin() + begin_[first], end = rows_.begin() + begin_[first + 1];
      slot = static_cast<std::uint32_t>(std::lower_bound(begin, end, second) - rows_.begin());
    }
    slot_.push_back(slot);
  }
  constexpr std::int64_t kBlock = 6 * 6 * 6, kColumn = 6 * 6;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const std::int64_t later = begin_[k + 1] - begin_[k];
    factor_work_ += kBlock * (1 + later + later * later);
    solve_work_ += kColumn * (1 + 2 * later);
  }
  factor_work_ += kPointWork * static_cast<std::int64_t>(system.columns());
}

void BodyBlocks::order() {
  const Index bodies = static_cast<Index>(system_.free().cols());
  std::vector<std::vector<Index>> neighbours(bodies);
  for (const Point& point : system_.points()) {
    if (point.i == kNone || point.j == kNone) continue;
    neighbours[point.i].push_back(point.j);
    neighbours[point.j].push_back(point.i);
  }
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

template <int kRows>
void BodyBlocks::addBlocks(const Rows& rows, const Mat36& DJ_i, const Mat36& DJ_j, std::uint32_t slot) {
  const auto add = [](Mat6& block, const Mat36& J, const Mat36& DJ) {
    block.template bottomRows<kRows>().noalias() += J.rightCols<kRows>().transpose() * DJ;
  };
  if (rows.i != kNone) add(diagonal_[place_[rows.i]], rows.J_i, DJ_i);
  if (rows.j != kNone) add(diagonal_[place_[rows.j]], rows.J_j, DJ_j);
  if (rows.i == kNone || rows.j == kNone) return;
  const bool i_first = place_[rows.i] < place_[rows.j];
  add(i_first ? lower_[slot] : upper_[slot], rows.J_j, DJ_i);
  add(i_first ? upper_[slot] : lower_[slot], rows.J_i, DJ_j);
}

void BodyBlocks::assemble(const std::vector<Mat3>& D, const std::vector<Vec3>& g) {
  for (Mat6& block : diagonal_) block.setIdentity();
  for (Mat6& block : lower_) block.setZero();
  for (Mat6& block : upper_) block.setZero();
  const std::vector<Point>& points = system_.points();
  for (std::size_t k = 0; k < points.size(); ++k) {
    Mat36 DJ_i, DJ_j;
    if (points[k].i != kNone) DJ_i.noalias() = D[k] * points[k].J_i;
    if (points[k].j != kNone) DJ_j.noalias() = D[k] * points[k].J_j;
    addBlocks<6>(points[k], DJ_i, DJ_j, slot_[k]);
  }
  // A couple turns, no more: three rows of its blocks are zero.
  for (std::size_t k = 0; k < g.size(); ++k) {
    const Couple& couple = system_.couples()[k];
    Vec6 n_i = Vec6::Zero(), n_j = Vec6::Zero();
    for (std::size_t p = couple.first; p < couple.first + couple.size; ++p) {
      n_i += D[p](2, 2) * points[p].J_i.row(2).transpose();
      n_j += D[p](2, 2) * points[p].J_j.row(2).transpose();
    }
    Mat36 DJ_i = g[k] * n_i.transpose(), DJ_j = g[k] * n_j.transpose();
    DJ_i.rightCols<3>() += D[points.size() + k] * couple.J_i.rightCols<3>();
    DJ_j.rightCols<3>() += D[points.size() + k] * couple.J_j.rightCols<3>();
    addBlocks<3>(couple, DJ_i, DJ_j, slot_[couple.first]);
  }
}

bool BodyBlocks::factor(const std::vector<Mat3>& D, const std::vector<Vec3>& g) {
  system_.spend(factor_work_);
  assemble(D, g);
  for (std::size_t k = 0; k < diagonal_.size(); ++k) {
    const Mat6 inverse = inverseOf(diagonal_[k]);
    if (!inverse.allFinite()) return false;
    diagonal_[k] = inverse;
    const std::uint32_t begin = begin_[k], end = begin_[k + 1];
    for (std::uint32_t a = begin; a < end; ++a) lower_[a] = lower_[a] * inverse;
    for (std::uint32_t a = begin; a < end; ++a) {
      const Index row = rows_[a];
      diagonal_[row].noalias() -= lower_[a] * upper_[a];
      std::uint32_t target = begin_[row];
      for (std::uint32_t b = a + 1; b < end; ++b) {
        while (rows_[target] != rows_[b]) ++target;
        lower_[target].noalias() -= lower_[b] * upper_[a];
        upper_[target].noalias() -= lower_[a] * upper_[b];
      }
    }
  }
  return true;
}

Velocities BodyBlocks::solve(const Velocities& y) const {
  system_.spend(solve_work_);
  Velocities x(6, y.cols());
  for (std::size_t k = 0; k < order_.size(); ++k) x.col(k) = y.col(order_[k]);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    for (std::uint32_t a = begin_[k]; a < begin_[k + 1]; ++a)
      x.col(rows_[a]).noalias() -= lower_[a] * x.col(k);
  }
  for (std::size_t k = order_.size(); k-- > 0;) {
    Vec6 sum = x.col(k);
    for (std::uint32_t a = begin_[k]; a < begin_[k + 1]; ++a) sum.noalias() -= upper_[a] * x.col(rows_[a]);
    x.col(k).noalias() = diagonal_[k] * sum;
  }
  Velocities result(6, y.cols());
  for (std::size_t k = 0; k < order_.size(); ++k) result.col(order_[k]) = x.col(k);
  return result;
}

}  // namespace rbs::coulomb

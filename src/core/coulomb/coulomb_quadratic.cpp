// SPDX-License-Identifier: BSD-3-Clause
// The problem without friction: a convex quadratic program, by an augmented Lagrangian.
//
// Without friction and torques each row, the normal of a point or one row of a joint, has an impulse r between two bounds, and
// obeys the law of BoxSet. That is to minimise |y - y_free|^2/2, under u = J y + bias >= 0 at points and u = 0 in rows without
// bounds, with a cost linear in u where a bound is finite and not 0. The problem is strictly convex: there is at most one y,
// whatever rows are redundant (J. J. Moreau, "Quadratic programming in mechanics", 1966). So a method that goes down cannot get
// stuck, as those for friction may.
//
// A round holds the impulses r and looks for the velocities x that the next ones add to y. With u = u_r + J x, u_r the velocity
// that r alone makes, z = r - rho u and P the nearest impulse within the bounds, x minimises
//   phi(x) = |x|^2/2 + sum of psi(u),   psi'(u) = r - P(z).
// That is convex, and quadratic in pieces. With d = P(z) - r and the identity 1, its gradient and its Hessian are
//   F = x - J^T d,   1 + J^T D J,   D = rho where z is within its bounds, and 0 beyond.
// Newton's step is followed to the minimum of phi along it. The slope of phi along it is linear in pieces and grows; its zero is
// found by going through the rows in the order in which they enter or leave their bounds. So phi falls with each step, and a
// round ends with the first that crosses no bound (A. Hermans, A. Themelis and P. Patrinos, "QPALM", 2019, with this search in
// section 3.2). Then r becomes P(z): a step of the proximal point method (R. T. Rockafellar 1976), which leaves about
// 1/(1 + rho w) of the error, w being the smallest eigenvalue but 0 of J J^T in the rows that push.
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace rbs::coulomb {

namespace {

constexpr double kFirstStiffness = 1e3, kMostStiffness = 1e10;  // in units of 1/response
constexpr double kGrowth = 10.0;                                // of the stiffness from one round to the next
constexpr double kSlow = 0.1;           // what a round leaves of the error at most, or the stiffness grows
constexpr double kHardlyLess = 0.5;     // of what the last round has left
constexpr int kMostSteps = 100;         // of a round: by rounding, steps may cross one bound to and fro
constexpr std::int64_t kRowWork = 500;  // multiplications of a round by column, for its residuals

class Rounds {
 public:
  Rounds(const System& system, BodyBlocks& matrix)
      : system_(system), matrix_(matrix), D_(system.columns(), Mat3::Zero()) {
    const double infinite = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < system.points().size(); ++k)
      rows_.push_back({k, 2, 0.0, infinite, system.points()[k].response});
    for (std::size_t k = 0; k < system.joints().size(); ++k) {
      const JointRows& joint = system.joints()[k];
      for (int c = 0; c < 3; ++c)
        rows_.push_back({system.firstJoint() + k, c, joint.box.lo[c], joint.box.hi[c], joint.response});
    }
  }

  /// One round from impulses r, which make velocities u_r: r becomes the next ones. False where it was cut off, since the
  /// matrix is singular, or after `cap` iterations in all, or by the budget.
  bool run(Impulses& r, const Impulses& u_r, double stiffness, int cap, int& iterations) {
    for (Row& row : rows_) {
      row.rho = stiffness / row.response;
      row.z = r(row.c, row.column) - row.rho * u_r(row.c, row.column);
    }
    Velocities x = Velocities::Zero(6, system_.free().cols());
    bool is_cut_off = false;
    crosses_ = true;
    for (int step = 0; crosses_ && step < kMostSteps; ++step) {
      updateD();
      is_cut_off = !factorD(cap, iterations);
      if (is_cut_off) break;
      Velocities F = x;
      system_.push(-change(r), F);
      const Velocities dx = matrix_.solve(F);
      for (Row& row : rows_)
        row.along = row.rho * System::changed(system_.rows(row.column), Vec3::Zero(), dx)[row.c];
      const double part = minimumAlong(-F.cwiseProduct(dx).sum(), dx.squaredNorm());
      if (!(part > 0.0)) break;
      x -= part * dx;
      for (Row& row : rows_) row.z += part * row.along;
    }
    for (const Row& row : rows_) r(row.c, row.column) = row.nearest();
    return !is_cut_off;
  }

 private:
  struct Row {
    std::size_t column;  // of impulses
    int c;               // in that column
    double lo, hi, response;
    double rho = 0.0, z = 0.0;
    double along = 0.0;  // what the step changes z by
    bool isWithin() const { return lo < z && z < hi; }
    double nearest() const { return std::clamp(z, lo, hi); }  // P(z)
  };

  // Takes D for the rows as they are.
  void updateD() {
    for (const Row& row : rows_) {
      const double D = row.isWithin() ? row.rho : 0.0;
      if (std::exchange(D_[row.column](row.c, row.c), D) != D) are_factors_of_D_ = false;
    }
  }

  // False where run() is to be cut off.
  bool factorD(int cap, int& iterations) {
    if (are_factors_of_D_) return true;
    if (iterations >= cap || system_.isBudgetSpent()) return false;
    ++iterations;
    are_factors_of_D_ = matrix_.factor(D_, {});
    return are_factors_of_D_;
  }

  // d
  Impulses change(const Impulses& r) const {
    Impulses d = Impulses::Zero(3, r.cols());
    for (const Row& row : rows_) d(row.c, row.column) = row.nearest() - r(row.c, row.column);
    return d;
  }

  // The part of a step at which phi is least along it. `slope` is that of phi at its start, and `growth` what |x|^2/2 makes it
  // grow by.
  double minimumAlong(double slope, double growth) {
    bounds_.clear();
    for (const Row& row : rows_) {
      if (row.along == 0.0) continue;
      const double by_row = row.along * row.along / row.rho;
      const double enters = ((row.along > 0.0 ? row.lo : row.hi) - row.z) / row.along;
      const double leaves = ((row.along > 0.0 ? row.hi : row.lo) - row.z) / row.along;
      if (row.isWithin()) growth += by_row;
      if (!row.isWithin() && enters >= 0.0) bounds_.emplace_back(enters, by_row);
      if (leaves > 0.0) bounds_.emplace_back(leaves, -by_row);
    }
    std::sort(bounds_.begin(), bounds_.end());
    double part = 0.0;
    crosses_ = false;
    for (const auto& [next, change] : bounds_) {
      const double then = slope + growth * (next - part);
      if (!(then < 0.0)) break;
      slope = then, part = next, growth += change;
      crosses_ = true;
    }
    return part - slope / growth;
  }

  const System& system_;
  BodyBlocks& matrix_;
  std::vector<Row> rows_;
  std::vector<Mat3> D_;  // by column
  bool are_factors_of_D_ = false;
  bool crosses_ = false;  // the last step: a bound, so that phi has other coefficients at its end
  std::vector<std::pair<double, double>>
      bounds_;  // reached along a step: where, and how the growth changes there
};

}  // namespace

bool isFrictionless(const System& system) {
  return system.torques().empty() &&
         std::all_of(system.points().begin(), system.points().end(),
                     [](const Point& point) { return point.sliding.factor == 0.0; });
}

Answer quadratic(const System& system, BodyBlocks& matrix, const Answer& start, double tolerance, int cap,
                 double enough) {
  Answer best{start.r, start.residuals, 0};
  Rounds rounds(system, matrix);
  Impulses r = start.r, u = system.relativeVelocities(r);
  double last = best.residuals.beyond_rounding, stiffness = kFirstStiffness;
  for (bool goes_on = true; goes_on && !system.isBudgetSpent();) {
    // Within the tolerance one more round follows, where no matrix is factored for it: its digits cost next to nothing, and
    // spare the next step a solve.
    const bool is_last = best.within(tolerance);
    goes_on = rounds.run(r, u, stiffness, is_last ? best.iterations : cap, best.iterations) && !is_last;
    if (!r.allFinite()) break;
    system.spend(kRowWork * static_cast<std::int64_t>(system.columns()));
    u = system.relativeVelocities(r);
    const Residuals residuals = system.residuals(r, u);
    const double now = residuals.beyond_rounding;
    if (!std::isfinite(now)) break;
    const bool is_better =
        is_last ? residuals.worst() < best.residuals.worst() : now < best.residuals.beyond_rounding;
    if (is_better) best.r = r, best.residuals = residuals;
    if (now <= tolerance) continue;
    if (now <= enough && now > kHardlyLess * last) break;
    if (now > kSlow * last) {
      if (stiffness == kMostStiffness) break;
      stiffness = std::min(kGrowth * stiffness, kMostStiffness);
    }
    last = now;
  }
  return best;
}

}  // namespace rbs::coulomb

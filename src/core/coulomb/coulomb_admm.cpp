// SPDX-License-Identifier: BSD-3-Clause
// Alternating direction method of multipliers, for the Coulomb problem as in Carpentier, Le Lidec and
// Montaut, "From compliant to rigid contact simulation", 2024.
//
// De Saxce (1992): with the shift s = mu |u_T| n, Coulomb's law is K* containing u + s, K containing r, and
// r.(u + s) = 0, where K is the cone |r_T| <= mu r_n and K* its dual. For a given s that is a convex problem:
// the least |y - y_free|^2/2 with w = J y + bias + s in K*, and r its multiplier. With rho > 0, a step is
//   (1 + J^T rho J) y = y_free + J^T (r + rho (w - bias - s))
//   v = a (J y + bias + s) + (1 - a) w
//   r' = P_K(r - rho v),   w' = v + (r' - r)/rho,
// a = 1.6 being over-relaxation, and s is taken anew from y. The matrix changes with rho only, and rho only
// where the residuals of the two equations, J y + bias + s - w and rho (w' - w), are far from equal (Boyd et
// al. 2011, 3.4.1). A torque constraint has for K its disc of rolling and its interval of spinning under the normal
// impulses that its points have just got, and no shift; a joint has its bounds. That it converges for Coulomb's problem, where
// s and the bounds of torques move, is not a theorem.
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>

namespace rbs::coulomb {

namespace {

constexpr double kRelaxation = 1.6;
constexpr int kFirstRhos = 15, kRhosEvery = 10;  // steps
constexpr double kUneven = 3.0;                  // a ratio of residuals that calls for another rho
constexpr double kMostRho = 1e3;                 // joints without bounds leave nothing of the second equation
constexpr int kCheckEvery = 5;

}  // namespace

Answer admm(const System& system, BodyBlocks& matrix, const Impulses& start, double tolerance, int cap) {
  const std::vector<Point>& points = system.points();
  const std::size_t columns = system.columns();
  Answer best{start, system.residuals(start), 0};
  Impulses r = start, w = system.relativeVelocities(start);
  std::vector<Vec3> s(columns, Vec3::Zero());
  const auto setShift = [&](std::size_t k, const Vec3& u) {
    const FrictionSet<2>& sliding = points[k].sliding;
    if (!sliding.slips) s[k][2] = sliding.factor * u.head<2>().norm();
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    setShift(k, w.col(k));
    const Vec3 v = w.col(k) + s[k];
    w.col(k) = v + nearestOnCone(points[k].sliding, -v);
  }
  std::vector<Mat3> D(columns);
  const std::vector<Vec3> g(system.torques().size(), Vec3::Zero());
  double rho = 1.0;  // in units of 1/response
  const auto factor = [&] {
    for (std::size_t k = 0; k < columns; ++k) D[k] = rho / system.rows(k).response * Mat3::Identity();
    return matrix.factor(D, g);
  };
  if (!factor()) return best;
  while (best.iterations < cap && !system.isBudgetSpent()) {
    const int step = ++best.iterations;
    Velocities right = system.free();
    for (std::size_t k = 0; k < columns; ++k) {
      const Rows& rows = system.rows(k);
      const Vec3 wanted = w.col(k) - rows.bias - s[k];
      System::push(rows, r.col(k) + rho / rows.response * wanted, right);
    }
    const Velocities y = matrix.solve(right);
    double primal = 0.0, dual = 0.0;
    for (std::size_t k = 0; k < columns; ++k) {
      const Rows& rows = system.rows(k);
      const double stiffness = rho / rows.response;
      const Vec3 u = system.velocity(rows, y);
      const Vec3 shifted = u + s[k];
      const Vec3 relaxed = kRelaxation * shifted + (1.0 - kRelaxation) * w.col(k);
      // Points come first, so that torques find their new normal impulses.
      const Vec3 r_new = system.nearest(k, r.col(k) - stiffness * relaxed, r);
      const Vec3 w_new = relaxed + (r_new - r.col(k)) / stiffness;
      primal += (shifted - w_new).squaredNorm();
      dual += rho * rho * (w_new - w.col(k)).squaredNorm();
      r.col(k) = r_new;
      w.col(k) = w_new;
      if (k < points.size()) setShift(k, u);
    }
    if (step % kCheckEvery == 0) {
      const Residuals residuals = system.residuals(r);
      if (residuals.beyond_rounding < best.residuals.beyond_rounding) best.r = r, best.residuals = residuals;
      if (best.within(tolerance)) break;
    }
    if (step < kFirstRhos || step % kRhosEvery != 0) continue;
    const double ratio = std::sqrt(primal / dual);
    if (!(ratio > kUneven || ratio < 1.0 / kUneven) || !std::isfinite(ratio)) continue;
    rho *= std::sqrt(ratio);
    if (!system.joints().empty()) rho = std::min(rho, kMostRho);
    if (!factor()) break;
  }
  return best;
}

}  // namespace rbs::coulomb

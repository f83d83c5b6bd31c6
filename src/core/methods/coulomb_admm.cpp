// SPDX-License-Identifier: BSD-3-Clause
// Alternating direction method of multipliers, for the Coulomb problem as in Carpentier, Le Lidec and
// Montaut, "From compliant to rigid contact simulation", 2024.
//
// De Saxce (1992): with the shift s = mu |u_T| n, Coulomb's law is K* containing u + s, K containing r, and
// r.(u + s) = 0, where K is the cone |r_T| <= mu r_n and K* its dual. For a given s that is a convex problem:
// the least |y - y_free|^2/2 with w = J y + drive + s in K*, and r its multiplier. With rho > 0, a step is
//   (1 + J^T rho J) y = y_free + J^T (r + rho (w - drive - s))
//   v = a (J y + drive + s) + (1 - a) w
//   r' = P_K(r - rho v),   w' = v + (r' - r)/rho,
// a = 1.6 being over-relaxation, and s is taken anew from y. The matrix changes with rho only, and rho only
// where the residuals of the two equations, J y + drive + s - w and rho (w' - w), are far from equal (Boyd et
// al. 2011, 3.4.1). That it converges for Coulomb's problem, where s moves, is not a theorem.
#include "methods/coulomb_solvers.h"

#include <cmath>

namespace rbs::coulomb {

namespace {

constexpr double kRelaxation = 1.6;
constexpr int kFirstRhos = 15, kRhosEvery = 10;  // steps
constexpr double kUneven = 3.0;                  // a ratio of residuals that calls for another rho
constexpr int kCheckEvery = 5;

}  // namespace

Answer admm(const System& system, BodyBlocks& matrix, const Impulses& start, double tolerance, int cap) {
  const std::vector<Point>& points = system.points();
  Answer best{start, system.residuals(start), 0};
  Impulses r = start, w = system.relativeVelocities(start);
  std::vector<Vec3> s(points.size(), Vec3::Zero());
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!points[k].slides) s[k][2] = points[k].mu * w.col(k).head<2>().norm();
    const Vec3 v = w.col(k) + s[k];
    w.col(k) = v + nearestOnCone(points[k], -v);
  }
  std::vector<Mat3> D(points.size());
  double rho = 1.0;  // in units of 1/response
  const auto factor = [&] {
    for (std::size_t k = 0; k < points.size(); ++k) D[k] = rho / points[k].response * Mat3::Identity();
    return matrix.factor(D);
  };
  if (!factor()) return best;
  while (best.iterations < cap && !system.isLate()) {
    const int step = ++best.iterations;
    Velocities right = system.free();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 wanted = w.col(k) - points[k].drive - s[k];
      System::push(points[k], r.col(k) + rho / points[k].response * wanted, right);
    }
    const Velocities y = matrix.solve(right);
    double primal = 0.0, dual = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point& point = points[k];
      const double stiffness = rho / point.response;
      const Vec3 u = system.velocity(point, y);
      const Vec3 shifted = u + s[k];
      const Vec3 relaxed = kRelaxation * shifted + (1.0 - kRelaxation) * w.col(k);
      const Vec3 r_new = nearestOnCone(point, r.col(k) - stiffness * relaxed);
      const Vec3 w_new = relaxed + (r_new - r.col(k)) / stiffness;
      primal += (shifted - w_new).squaredNorm();
      dual += rho * rho * (w_new - w.col(k)).squaredNorm();
      r.col(k) = r_new;
      w.col(k) = w_new;
      if (!point.slides) s[k][2] = point.mu * u.head<2>().norm();
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
    if (!factor()) break;
  }
  return best;
}

}  // namespace rbs::coulomb

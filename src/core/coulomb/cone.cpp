// SPDX-License-Identifier: BSD-3-Clause
#include "coulomb/cone.h"

#include "base/bracket.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace rbs {

namespace {

using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

// The sliding contact. u_n = 0 gives r_n = -(q_n + w.r_T)/W_nn with w = W_Tn; put into u_T it gives
//   u_T = p + S r_T,   p = q_T - w q_n/W_nn,   S = W_TT - w w^T/W_nn  (the Schur complement).
// Friction opposes sliding: u_T = -a r_T with a >= 0, so r_T(a) = -(S + a)^-1 p. What is left is one equation
// in a: |r_T(a)| = mu r_n(a). At a = 0 (sticking) the left side is larger, or this would not be called; as a
// grows r_T vanishes and r_n tends to -q_n/W_nn > 0. So there is a root, found by bisection on the exponent
// first and by false position then.
class Sliding {
 public:
  Sliding(const Mat3& W, const Vec3& q, double mu)
      : w_(W.topRightCorner<2, 1>()), W_nn_(W(2, 2)), q_n_(q[2]), mu_(mu) {
    const Mat2 S = W.topLeftCorner<2, 2>() - w_ * w_.transpose() / W_nn_;
    const Eigen::SelfAdjointEigenSolver<Mat2> eigen(S);
    axes_ = eigen.eigenvectors();
    values_ = eigen.eigenvalues().cwiseMax(0.0);
    p_ = axes_.transpose() * (q.head<2>() - w_ * q_n_ / W_nn_);
  }

  Vec3 solve() const {
    double low = 0.0, high = std::max(values_[1], 1e-300);
    while (excess(high) > 0.0) low = high, high *= 4.0;
    const double f_low = excess(low);
    if (f_low <= 0.0) return impulse(low);  // it sticks, but for rounding
    Bracket root(low, f_low, high, excess(high));
    for (int k = 0; k < 200 && root.width() > 1e-16 * root.high(); ++k) {
      const double middle = 0.5 * (root.low() + root.high());
      double a = root.low() == 0.0 || k % 8 == 7 ? middle : root.guess();
      if (!(a > root.low() && a < root.high())) a = middle;
      const double f = excess(a);
      if (f == 0.0) return impulse(a);
      root.narrow(a, f);
    }
    Vec3 r = impulse(root.high());
    const double length = r.head<2>().norm();
    if (length > 0.0) r.head<2>() *= mu_ * r[2] / length;  // on the cone to rounding
    return r;
  }

 private:
  Vec2 tangential(double a) const { return -(axes_ * p_.cwiseQuotient(values_ + Vec2::Constant(a))); }
  double normal(const Vec2& r_T) const { return -(q_n_ + w_.dot(r_T)) / W_nn_; }
  Vec3 impulse(double a) const {
    const Vec2 r_T = tangential(a);
    return {r_T.x(), r_T.y(), normal(r_T)};
  }
  // |r_T| - mu r_n; infinite where S + a is singular.
  double excess(double a) const {
    if (values_[0] + a <= 0.0) return 1e300;
    const Vec2 r_T = tangential(a);
    return r_T.norm() - mu_ * normal(r_T);
  }

  Vec2 w_;
  double W_nn_, q_n_, mu_;
  Mat2 axes_;
  Vec2 values_, p_;
};

}  // namespace

Vec3 solveContact(const Mat3& W, const Vec3& q, double mu) {
  if (q[2] >= 0.0) return Vec3::Zero();
  if (mu == 0.0) return {0.0, 0.0, -q[2] / W(2, 2)};
  const Vec3 stick = -W.ldlt().solve(q);
  if (stick[2] >= 0.0 && stick.head<2>().norm() <= mu * stick[2]) return stick;
  return Sliding(W, q, mu).solve();
}

}  // namespace rbs

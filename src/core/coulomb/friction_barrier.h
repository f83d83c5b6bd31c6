// SPDX-License-Identifier: BSD-3-Clause
// The barrier of a friction set for interior point methods: a complementary pair of vectors in second-order
// cones, and Newton's method for it.
//
// With the impulse x, the slip w and a free speed a, the pair is
//   b = (x, factor N),   h = (w, a),   |.| <= last,   b o h = t e,
// x o z being the Jordan product of the cone (Alizadeh and Goldfarb 2003; the pair as in Howell et al.,
// "Dojo", 2022). At t = 0 it is Coulomb's law: a = |w|, and x opposes w at its limit or w = 0. The speed a
// has no place in the dynamics.
//
// With the scaling W of Nesterov and Todd (1997; the formulas are those of Andersen, Dahl and Vandenberghe
// 2003), W h = W^-1 b = l, and wanted changes k of l o l, Newton's step is
//   db = q - W^2 dh,   q = W (l \ k).
// With W^2 in blocks A (of x), v (of x and last) and g (last), and db_last = factor dN, which gives da,
//   dx = q_x - v/g (q_last - factor dN) - (A - v v^T/g) dw.
#pragma once

#include "coulomb/friction_set.h"

#include <algorithm>
#include <limits>

namespace rbs::coulomb {

/// How many times a change can be added to a number until it is negative.
inline double roomWithin(double x, double d) {
  return d < 0.0 ? -x / d : std::numeric_limits<double>::infinity();
}

/// The pair, or a change of it; zero where the set is no ball.
template <int n>
struct ConePair {
  using Full = Eigen::Matrix<double, n + 1, 1>;
  Full b = Full::Zero(), h = Full::Zero();

  void add(double part, const ConePair& change) {
    b += part * change.b;
    h += part * change.h;
  }
  /// How many times a change can be added until a vector leaves its cone.
  double room(const ConePair& change) const {
    return std::min(roomInCone(b, change.b), roomInCone(h, change.h));
  }

  /// A change as a fraction of the lasts.
  Eigen::Matrix<double, 2 * n + 2, 1> relative(const ConePair& change) const {
    Eigen::Matrix<double, 2 * n + 2, 1> fractions;
    fractions << change.b / b[n], change.h / h[n];
    return fractions;
  }

  // --- vectors of the cone |x| <= last
  static double determinant(const Full& x) {
    const double length = x.template head<n>().norm();
    return (x[n] - length) * (x[n] + length);
  }
  static Full product(const Full& a, const Full& b) {
    Full c;
    c << a[n] * b.template head<n>() + b[n] * a.template head<n>(), a.dot(b);
    return c;
  }
  /// x of a o x = b.
  static Full quotient(const Full& b, const Full& a) {
    Full x;
    x[n] = (a[n] * b[n] - a.template head<n>().dot(b.template head<n>())) / determinant(a);
    x.template head<n>() = (b.template head<n>() - x[n] * a.template head<n>()) / a[n];
    return x;
  }

 private:
  static double roomInCone(const Full& x, const Full& d) {
    // det(x + t d) = a t^2 + 2 b t + c; its least positive root.
    const double a = determinant(d), c = std::max(determinant(x), 0.0);
    const double b = x[n] * d[n] - x.template head<n>().dot(d.template head<n>());
    double t = roomWithin(x[n], d[n]);
    const double root = b * b - a * c;
    if (root < 0.0) return t;
    const double q = -(b + std::copysign(std::sqrt(root), b));
    if (q / a > 0.0) t = std::min(t, q / a);
    if (c / q > 0.0) t = std::min(t, c / q);
    return t;
  }
};

/// Newton's method for the pair of one friction set at a place.
template <int n>
class FrictionBarrier {
 public:
  using Pair = ConePair<n>;
  using Full = typename Pair::Full;
  using Vec = Eigen::Matrix<double, n, 1>;
  using Mat = Eigen::Matrix<double, n, n>;

  explicit FrictionBarrier(const FrictionSet<n>& set) : set_(set) {}

  bool isBall() const { return set_.isBall(); }
  /// A place with the product N speed: no impulse under the normal impulse N, and no slip.
  Pair start(double N, double speed) const {
    Pair pair;
    if (isBall()) pair.b[n] = set_.factor * N, pair.h[n] = speed / set_.factor;
    return pair;
  }
  /// The place of an impulse of the set under N and of a slip, on the boundary.
  Pair placeOf(const Vec& impulse, double N, const Vec& slip) const {
    Pair pair;
    if (!isBall()) return pair;
    pair.b.template head<n>() = impulse, pair.b[n] = set_.factor * N;
    pair.h.template head<n>() = slip, pair.h[n] = slip.norm();
    return pair;
  }
  Vec impulse(const Pair& pair, double N) const {
    return isBall() ? Vec(pair.b.template head<n>()) : Vec(-(set_.factor * N) * set_.slip);
  }

  void linearise(const Pair& pair);
  /// How far the product is from t e, as a fraction of t.
  double distance(double t) const {
    return isBall() ? (Pair::product(l_, l_) / t - Full::Unit(n)).norm() : 0.0;
  }

  /// -dx/dw.
  Mat stiffness() const {
    if (!isBall()) return Mat::Zero();
    const Vec v = side();
    return square_.template topLeftCorner<n, n>() - v * v.transpose() / square_(n, n);
  }
  /// dx for a change of N by `change`.
  Vec byNormal(double change) const {
    if (!isBall()) return -set_.factor * change * set_.slip;
    return set_.factor * change / square_(n, n) * side();
  }

  /// The wanted change of l o l as q: towards t e, with the second order of an earlier step where there is
  /// one.
  Full towards(double t, const Pair* earlier) const;
  Full alongPath(double t) const { return isBall() ? scaled(t * Full::Unit(n)) : Full(Full::Zero()); }
  /// The part of dx that neither dw nor more than `change` of dN makes.
  Vec constant(const Full& q, double change) const {
    if (!isBall()) return byNormal(change);
    return q.template head<n>() - side() / square_(n, n) * (q[n] - set_.factor * change);
  }
  /// The change of the pair for a slip that changes by dw under N that changes by dN.
  Pair change(const Full& q, const Vec& dw, double dN) const;

 private:
  Vec side() const { return square_.template topRightCorner<n, 1>(); }
  Full scaled(const Full& wanted) const { return W_ * Pair::quotient(wanted, l_); }

  FrictionSet<n> set_;
  using Square = Eigen::Matrix<double, n + 1, n + 1>;
  Square W_ = Square::Zero(), inverse_ = Square::Zero(), square_ = Square::Zero();
  Full l_ = Full::Zero();
};

template <int n>
void FrictionBarrier<n>::linearise(const Pair& pair) {
  if (!isBall()) return;
  const double size_b = std::sqrt(Pair::determinant(pair.b)), size_h = std::sqrt(Pair::determinant(pair.h));
  Full mirror = -Full::Ones();
  mirror[n] = 1.0;
  const Full unit_b = pair.b / size_b, unit_h = pair.h / size_h;
  const Full w = (unit_b + mirror.cwiseProduct(unit_h)) / std::sqrt(2.0 * (1.0 + unit_b.dot(unit_h)));
  const double ratio = size_b / size_h, root = std::sqrt(ratio);
  W_.template topLeftCorner<n, n>() =
      Mat::Identity() + w.template head<n>() * w.template head<n>().transpose() / (1.0 + w[n]);
  W_.col(n) = w;
  W_.row(n) = w.transpose();
  inverse_ = mirror.asDiagonal() * W_ * mirror.asDiagonal();
  W_ *= root;
  inverse_ /= root;
  square_ = ratio * (2.0 * w * w.transpose());
  square_.diagonal() -= ratio * mirror;
  l_ = W_ * pair.h;
}

template <int n>
typename FrictionBarrier<n>::Full FrictionBarrier<n>::towards(double t, const Pair* earlier) const {
  if (!isBall()) return Full::Zero();
  Full wanted = t * Full::Unit(n) - Pair::product(l_, l_);
  if (earlier) wanted -= Pair::product(inverse_ * earlier->b, W_ * earlier->h);
  return scaled(wanted);
}

template <int n>
typename FrictionBarrier<n>::Pair FrictionBarrier<n>::change(const Full& q, const Vec& dw, double dN) const {
  Pair d;
  if (!isBall()) return d;
  const Vec v = side();
  d.b[n] = set_.factor * dN;
  d.h << dw, (q[n] - v.dot(dw) - d.b[n]) / square_(n, n);
  d.b.template head<n>() = q.template head<n>() - v * d.h[n] - square_.template topLeftCorner<n, n>() * dw;
  return d;
}

}  // namespace rbs::coulomb

// SPDX-License-Identifier: BSD-3-Clause
// The free top: with l the angular momentum in the body frame, L = |l| and a = 1/I,
//   dl/dt = l x (a l),
// and the orientation follows from R l being constant but for the angle about it, which is an integral of l.
//
// C. G. J. Jacobi, "Sur la rotation d'un corps", J. reine angew. Math. 39, 1850; the integral in the form of
// E. Celledoni, F. Fasso, N. Saefstroem, A. Zanna, "The exact computation of the free rigid body motion and
// its use in splitting methods", SIAM J. Sci. Comput. 30(4), 2008.
//
// Let m = l/L, 2 the axis with the middle moment, p the one that m circles around and o the other one, with
//   c_p = |a_p - a_2|,  c_o = |a_o - a_2|,  c = c_p + c_o;   p is the one with c_p m_p² >= c_o m_o².
// Then  m_p = A_p dn u,  m_2 = A_2 sn u,  m_o = A_o cn u,  du/dt = +-L A_p sqrt(c c_p),  where
//   A_p² = m_p² + c_o/c m_2²,  A_2² = m_2² + c/c_p m_o²,  A_o² = m_o² + c_p/c m_2²,
//   k² = c_o A_o² / (c_p A_p²),   1 - k² = (c_p m_p² - c_o m_o²) / (c_p A_p²),
// sums of positive terms, but for the last, which tells how near the separatrix is. sn, cn and dn at the end
// follow from those at the start, which m gives, and those of the step v by their addition theorem, so that
// no elliptic integral is ever inverted.
//
// The line of nodes e x m, of an axis e of the body, turns about L at the rate
//   L (sum of a_i m_i² / sum of m_i² over the two other axes).
// Of e = p and e = o that one is taken whose rate has no pole near the real axis: p when c_o < c_p. With x
// the other one of the two, the rate is, in both cases with 0 <= N <= 1,
//   L (a_x + (a_2 - a_x) (1 + N)' sn² u / (1 + N sn² u)),   N = c_o/c_p for e = p,  A_o²/A_p² for e = o,
// and the angle of the second part is +-F(u) between the ends of the step, where
//   F(u) = f int_0^u sn²/(1 + N sn²),   f = sqrt(N (1 + N) (N + k²)),
// an elliptic integral of the third kind with the addition theorem
//   F(u + v) = F(u) + F(v) + arg(1 + N sn² w - N sn u sn v cn w dn w + i f sn u sn v sn w),   w = u + v.
// So only F(v) is needed: a series for a small argument, doubled by the addition theorems until it is v.
// These keep every digit, near the separatrix too: there cn and dn are small, and each stays right as a
// fraction of itself. Whole periods of v are taken out first.
#include "dynamics/free_top.h"

#include "base/algebra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

namespace rbs {

namespace {

using Complex = std::complex<double>;

struct Modulus {
  double k2, complement;  // k², and 1 - k² to its own last digit
  double N, f;
};

// The elliptic functions of one argument, and F as an angle and a unit complex number.
struct Elliptic {
  double sn = 0.0, cn = 1.0, dn = 1.0;
  double angle = 0.0;
  Complex turn = 1.0;
};

// For 0 <= v <= 1/16, where the first term left out is below rounding. With x = v², the series of y = sn² has
//   2n (2n - 1) y_n = 2 [n = 1] - 4 (1 + k²) y_(n-1) + 6 k² sum y_i y_(n-1-i),
// which is y'' = 2 - 4 (1 + k²) y + 6 k² y²; z = y/(1 + N y) is the integrand.
Elliptic ofSmall(double v, const Modulus& m) {
  constexpr int kTerms = 7;
  std::array<double, kTerms + 1> y{0.0, 1.0}, z{0.0, 1.0};
  const double x = v * v, linear = 4.0 * (1.0 + m.k2), quadratic = 6.0 * m.k2;
#pragma GCC unroll 8
  for (int n = 2; n <= kTerms; ++n) {
    double squares = 0.0, product = 0.0;
#pragma GCC unroll 8
    for (int i = 1; i < n - 1; ++i) squares += y[i] * y[n - 1 - i];
    y[n] = (quadratic * squares - linear * y[n - 1]) * (1.0 / (2 * n * (2 * n - 1)));
#pragma GCC unroll 8
    for (int i = 1; i < n; ++i) product += y[i] * z[n - i];
    z[n] = y[n] - m.N * product;
  }
  double sn2_over_x = 0.0, integral = 0.0;
#pragma GCC unroll 8
  for (int n = kTerms; n >= 1; --n) {
    sn2_over_x = sn2_over_x * x + y[n];
    integral = (integral + z[n] * (1.0 / (2 * n + 1))) * x;
  }
  Elliptic e;
  e.sn = v * std::sqrt(sn2_over_x);
  e.cn = std::sqrt(1.0 - e.sn * e.sn);
  e.dn = std::sqrt(m.complement + m.k2 * e.cn * e.cn);
  e.angle = m.f * v * integral;
  return e;
}

// What the addition theorem of F adds, as a complex number of unit length.
Complex added(const Elliptic& u, const Elliptic& v, const Elliptic& w, const Modulus& m) {
  const Complex z(1.0 + m.N * (w.sn * w.sn - u.sn * v.sn * w.cn * w.dn), m.f * u.sn * v.sn * w.sn);
  return z / std::sqrt(std::norm(z));
}

Elliptic doubled(const Elliptic& u, const Modulus& m) {
  const double s2 = u.sn * u.sn, c2 = u.cn * u.cn, d2 = u.dn * u.dn, under = c2 + s2 * d2;
  Elliptic w;
  w.sn = 2.0 * u.sn * u.cn * u.dn / under;
  // The first keeps sn² + cn² = 1, the second the digits of a small cn; dn follows from cn.
  w.cn = s2 < 0.5 ? 1.0 - 2.0 * s2 * d2 / under : (m.k2 * c2 * c2 - m.complement * (s2 - c2)) / under;
  w.dn = std::sqrt(m.complement + m.k2 * w.cn * w.cn);
  w.angle = 2.0 * u.angle;
  w.turn = u.turn * u.turn * added(u, u, w, m);
  return w;
}

// For 0 <= v, up to a quarter of a period.
Elliptic ofQuarter(double v, const Modulus& m) {
  int doublings = 0;
  for (; v > 0.0625; v *= 0.5) ++doublings;
  Elliptic e = ofSmall(v, m);
  for (; doublings > 0; --doublings) e = doubled(e, m);
  return e;
}

// The quarter period, by the arithmetic-geometric mean.
double quarterPeriod(const Modulus& m) {
  double a = 1.0, b = std::sqrt(m.complement);
  while (a - b > 1e-8 * a) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b), a = mean;
  }
  return kPi / (a + b);
}

// For v >= 0. sn and cn change sign half a period on; F grows by the same amount with each half period.
Elliptic elliptic(double v, const Modulus& m) {
  if (v <= 0.5 * kPi) return ofQuarter(v, m);  // no quarter period is shorter
  const double quarter = quarterPeriod(m);
  const double halves = std::floor(0.5 * v / quarter + 0.5);
  const double rest = v - halves * (2.0 * quarter);
  Elliptic e = ofQuarter(std::min(std::abs(rest), quarter), m);
  if (rest < 0.0) e.sn = -e.sn, e.angle = -e.angle, e.turn = std::conj(e.turn);
  if (halves == 0.0) return e;
  if (std::fmod(halves, 2.0) != 0.0) e.sn = -e.sn, e.cn = -e.cn;
  const Elliptic q = ofQuarter(quarter, m);
  e.angle += halves * (2.0 * (q.angle + std::arg(q.turn)));
  return e;
}

Elliptic sum(const Elliptic& u, const Elliptic& v, const Modulus& m) {
  const double s = u.sn * v.sn, under = u.sn * u.sn * v.dn * v.dn + u.cn * u.cn;
  Elliptic w;
  w.sn = (u.sn * v.cn * v.dn + v.sn * u.cn * u.dn) / under;
  w.cn = (u.cn * v.cn - s * u.dn * v.dn) / under;
  w.dn = (u.dn * v.dn - m.k2 * s * u.cn * v.cn) / under;
  return w;
}

// The frame of line of nodes e x m, m x (e x m) and m. (f, g) are the other axes in cyclic order, (m_f, m_g)
// has the direction `across`.
Mat3 nodeFrame(const Vec3& m, int e, double across_f, double across_g) {
  const int f = (e + 1) % 3, g = (e + 2) % 3;
  const double r = std::sqrt(m[f] * m[f] + m[g] * m[g]);
  const double length = std::sqrt(across_f * across_f + across_g * across_g);
  const double df = across_f / length, dg = across_g / length;
  Mat3 T;
  T(e, 0) = 0.0, T(f, 0) = -dg, T(g, 0) = df;
  T(e, 1) = r, T(f, 1) = -m[e] * df, T(g, 1) = -m[e] * dg;
  T.col(2) = m;
  return T;
}

// Moments nearer to each other than this, as a fraction, are equal: no more than their own rounding.
constexpr double kEqual = 4.0 * std::numeric_limits<double>::epsilon();

bool areEqual(double smaller, double larger) {
  return larger - smaller <= kEqual * larger;
}

// The axes in the order of their moments.
std::array<int, 3> byMoment(const Vec3& I) {
  std::array<int, 3> axes{0, 1, 2};
  if (I[axes[0]] > I[axes[1]]) std::swap(axes[0], axes[1]);
  if (I[axes[1]] > I[axes[2]]) std::swap(axes[1], axes[2]);
  if (I[axes[0]] > I[axes[1]]) std::swap(axes[0], axes[1]);
  return axes;
}

// Two equal moments, about the axes other than s: two turns at constant rates, about l and about axis s.
FreeTurn symmetric(const Vec3& l, const Vec3& a, int s, double dt) {
  const int t = (s + 1) % 3;
  const double spin = (a[s] - a[t]) * l[s] * dt;
  const Quat about_axis = rotationBy(spin * Vec3::Unit(s));
  return {rotationBy(a[t] * dt * l) * about_axis, about_axis.conjugate() * l};
}

}  // namespace

FreeTurn turnFreely(const Vec3& l, const Inertia& inertia, double dt) {
  const Vec3 &I = inertia.moments, &a = inertia.inv_moments;
  const std::array<int, 3> axes = byMoment(I);
  int p = axes[0], o = axes[2];
  const int two = axes[1];
  if (areEqual(I[p], I[two])) return symmetric(l, a, o, dt);
  if (areEqual(I[two], I[o])) return symmetric(l, a, p, dt);

  const double L = l.norm();
  const Vec3 m = l / L;
  const auto apart = [&](int i, int j) { return std::abs(I[i] - I[j]) * a[i] * a[j]; };
  if (apart(p, two) * m[p] * m[p] < apart(o, two) * m[o] * m[o]) std::swap(p, o);
  const double c_p = apart(p, two), c_o = apart(o, two), c = c_p + c_o;
  const double mp2 = m[p] * m[p], m22 = m[two] * m[two], mo2 = m[o] * m[o];
  const double Ap2 = mp2 + c_o / c * m22, Ao2 = mo2 + c_p / c * m22;
  const double Ap = std::copysign(std::sqrt(Ap2), m[p]), A2 = std::sqrt(m22 + c / c_p * mo2),
               Ao = std::sqrt(Ao2);

  const bool nodes_of_p = c_o < c_p;
  Modulus modulus;
  // The floor keeps the period finite on the separatrix; it is as much as 1e-150 of m there.
  modulus.complement =
      std::max((std::sqrt(c_p) * std::abs(m[p]) - std::sqrt(c_o) * std::abs(m[o])) *
                   (std::sqrt(c_p) * std::abs(m[p]) + std::sqrt(c_o) * std::abs(m[o])) / (c_p * Ap2),
               1e-300);
  modulus.k2 = std::min(c_o * Ao2 / (c_p * Ap2), 1.0);
  modulus.N = nodes_of_p ? c_o / c_p : Ao2 / Ap2;
  modulus.f = std::sqrt(modulus.N * (1.0 + modulus.N) * (modulus.N + modulus.k2));

  Elliptic start;
  if (A2 > 0.0 && Ao > 0.0) {
    start.sn = m[two] / A2, start.cn = m[o] / Ao;
    start.dn = std::sqrt(modulus.complement + modulus.k2 * start.cn * start.cn);
  }
  // dm_2/dt = +-c L m_o m_p, plus when (2, o, p) are in cyclic order and a_p > a_o, or neither.
  const bool cyclic = o == (two + 1) % 3;
  const double direction = (cyclic == (a[p] > a[o])) == (m[p] > 0.0) ? 1.0 : -1.0;
  Elliptic step = elliptic(L * std::abs(Ap) * std::sqrt(c * c_p) * dt, modulus);
  step.sn *= direction;
  const Elliptic end = sum(start, step, modulus);

  Vec3 m_end;
  m_end[p] = Ap * end.dn, m_end[two] = A2 * end.sn, m_end[o] = Ao * end.cn;
  m_end.normalize();

  const int e = nodes_of_p ? p : o, x = nodes_of_p ? o : p;
  // Where m is along p, across it has a direction all the same.
  const double ratio = std::sqrt(c / c_p);
  const auto frame = [&](const Vec3& n, const Elliptic& u) {
    Vec3 across = n;
    if (nodes_of_p) across[two] = ratio * u.sn, across[o] = u.cn;
    return nodeFrame(n, e, across[(e + 1) % 3], across[(e + 2) % 3]);
  };
  const double sign = a[two] > a[x] ? 1.0 : -1.0;
  const Complex between = added(start, step, end, modulus);
  const Complex turn = step.turn * (direction > 0.0 ? between : std::conj(between));
  const Complex phase =
      std::polar(1.0, a[x] * L * dt + sign * step.angle) * (sign > 0.0 ? turn : std::conj(turn));
  Mat3 R_L = Mat3::Identity();
  R_L(0, 0) = R_L(1, 1) = phase.real();
  R_L(1, 0) = phase.imag(), R_L(0, 1) = -phase.imag();
  const Mat3 R_B0B = frame(m, start) * R_L * frame(m_end, end).transpose();
  return {Quat(R_B0B).normalized(), L * m_end};
}

// The components of l are l_i = L A_i times an elliptic function that is at most 1, or constant where two
// moments are equal. Euler's equations give dw_i/dt = a_i (I_j - I_k) w_j w_k.
SpinBounds spinBoundsOf(const Vec3& w, const Inertia& inertia) {
  const Vec3 &I = inertia.moments, &a = inertia.inv_moments;
  const std::array<int, 3> axes = byMoment(I);
  int p = axes[0], o = axes[2];
  const int two = axes[1];
  Vec3 most = w.cwiseAbs();
  const auto circles = [&](int i, int j) { most[i] = most[j] = std::hypot(w[i], w[j]); };
  if (areEqual(I[p], I[two])) {
    circles(p, two);
  } else if (areEqual(I[two], I[o])) {
    circles(two, o);
  } else {
    const Vec3 l = I.cwiseProduct(w);
    const auto apart = [&](int i, int j) { return std::abs(I[i] - I[j]) * a[i] * a[j]; };
    if (apart(p, two) * l[p] * l[p] < apart(o, two) * l[o] * l[o]) std::swap(p, o);
    const double c_p = apart(p, two), c_o = apart(o, two), c = c_p + c_o;
    most[p] = a[p] * std::hypot(l[p], std::sqrt(c_o / c) * l[two]);
    most[two] = a[two] * std::hypot(l[two], std::sqrt(c / c_p) * l[o]);
    most[o] = a[o] * std::hypot(l[o], std::sqrt(c_p / c) * l[two]);
  }
  Vec3 change;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    change[i] = a[i] * std::abs(I[j] - I[k]) * most[j] * most[k];
  }
  return {most.norm(), change.norm()};
}

}  // namespace rbs

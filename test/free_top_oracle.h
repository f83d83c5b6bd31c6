// SPDX-License-Identifier: BSD-3-Clause
// Euler's equations of a free top, integrated in long double.
#pragma once

#include "rigid_body_sim/types.h"

#include <array>
#include <cmath>

namespace rbs::oracle {

using Real = long double;
using Real3 = Eigen::Matrix<Real, 3, 1>;
/// q_B0B as x, y, z, w, and l in B.
using TopState = Eigen::Matrix<Real, 7, 1>;

inline TopState derivative(const TopState& s, const Real3& moments) {
  const Real3 l = s.tail<3>(), w = l.cwiseQuotient(moments), v = s.head<3>();
  TopState d;
  d.head<3>() = (s[3] * w + v.cross(w)) / 2;
  d[3] = -v.dot(w) / 2;
  d.tail<3>() = l.cross(w);
  return d;
}

// A step of the modified midpoint rule with 2, 4, ... 16 parts, extrapolated: order 16 (Gragg, Bulirsch,
// Stoer).
inline TopState extrapolated(const TopState& s, const Real3& moments, Real h) {
  constexpr int kRows = 8;
  std::array<TopState, kRows> row;
  for (int j = 0; j < kRows; ++j) {
    const int parts = 2 * (j + 1);
    const Real part = h / parts;
    TopState before = s, now = s + part * derivative(s, moments);
    for (int k = 1; k < parts; ++k) {
      const TopState next = before + 2 * part * derivative(now, moments);
      before = now, now = next;
    }
    TopState value = (before + now + part * derivative(now, moments)) / 2;
    for (int k = 1; k <= j; ++k) {
      const Real ratio = static_cast<Real>(j + 1) / (j + 1 - k);
      const TopState finer = value + (value - row[k - 1]) / (ratio * ratio - 1);
      row[k - 1] = value, value = finer;
    }
    row[j] = value;
  }
  return row[kRows - 1];
}

// The angular velocity is at most this, whatever the body does: the whole energy about the axis of the least
// moment.
inline double fastest(const Vec3& l, const Vec3& moments) {
  return std::sqrt(l.dot(l.cwiseQuotient(moments)) / moments.minCoeff());
}

inline TopState integrated(const Vec3& l, const Vec3& moments, double t) {
  const Real3 I = moments.cast<Real>();
  TopState s;
  s << 0, 0, 0, 1, l.cast<Real>();
  const int steps = static_cast<int>(std::ceil(fastest(l, moments) * t / 0.15)) + 1;
  for (int k = 0; k < steps; ++k) s = extrapolated(s, I, static_cast<Real>(t) / steps);
  return s;
}

inline Quat orientationOf(const TopState& s) {
  return Quat(Eigen::Quaternion<Real>(s[3], s[0], s[1], s[2]).normalized().cast<double>());
}

inline double angleBetween(const Quat& p, const Quat& q) {
  return 2.0 * (p.conjugate() * q).vec().norm();
}

}  // namespace rbs::oracle

// SPDX-License-Identifier: BSD-3-Clause
// Small algebra that several files share.
#pragma once

#include "rigid_body_sim/types.h"

#include <cmath>
#include <utility>

namespace rbs {

inline constexpr double kPi = 3.14159265358979323846;

/// The matrix [r] with [r] x = r cross x.
inline Mat3 crossMatrix(const Vec3& r) {
  Mat3 m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

/// The moment about an axis, of length 1, of a unit impulse along n at r from a centre on that axis, m. 0 where the axis is
/// zero.
inline double momentAbout(const Vec3& axis, const Vec3& r, const Vec3& n) {
  return axis.isZero(0.0) ? 0.0 : axis.dot(r.cross(n));
}

/// Velocity of a point of a body at r from its centre, m/s.
inline Vec3 velocityAt(const Twist& twist, const Vec3& r) {
  return twist.v_WB + twist.w_WB.cross(r);
}

/// exp(theta): the turn by |theta| radians about theta.
inline Quat rotationBy(const Vec3& theta) {
  const double square = 0.25 * theta.squaredNorm();
  double cosine, half_sinc;  // cos(x), sin(x)/(2 x) at x = |theta|/2
  if (square < 0.01) {
    // Their series, to terms below 2e-18.
    const double s = square;
    const double c6 = 1.0 - s * (1.0 / 56) * (1.0 - s * (1.0 / 90));
    cosine = 1.0 - s * (1.0 / 2) * (1.0 - s * (1.0 / 12) * (1.0 - s * (1.0 / 30) * c6));
    half_sinc =
        0.5 - s * (1.0 / 12) * (1.0 - s * (1.0 / 20) * (1.0 - s * (1.0 / 42) * (1.0 - s * (1.0 / 72))));
  } else {
    const double half = std::sqrt(square);
    cosine = std::cos(half), half_sinc = 0.5 * std::sin(half) / half;
  }
  return Quat(cosine, half_sinc * theta.x(), half_sinc * theta.y(), half_sinc * theta.z());
}

/// Two unit vectors that make a right-handed frame (t1, t2, n) with the unit vector n. Duff et al.,
/// "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
inline std::pair<Vec3, Vec3> tangents(const Vec3& n) {
  const double sign = n.z() < 0.0 ? -1.0 : 1.0;
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  return {Vec3(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

}  // namespace rbs

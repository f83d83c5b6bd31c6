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

/// exp(theta): the turn by |theta| radians about theta.
inline Quat rotationBy(const Vec3& theta) {
  const double angle = theta.norm();
  // sin(x)/x to full precision near zero, where the quotient would lose it.
  const double half = 0.5 * angle;
  const double s = half < 1e-4 ? 0.5 * (1.0 - half * half / 6.0) : std::sin(half) / angle;
  return Quat(std::cos(half), s * theta.x(), s * theta.y(), s * theta.z());
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

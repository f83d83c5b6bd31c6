// SPDX-License-Identifier: BSD-3-Clause
// Two boxes are apart if and only if they are apart along the normal of a face of one or along the cross
// product of an edge of each: S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996. Along a unit
// axis l, with p the centre of B seen from A and a_i, b_j the half edges as vectors,
//   separation = |l.p| - sum |l.a_i| - sum |l.b_j|.
#include "narrowphase/box_axes.h"
#include "narrowphase/tolerances.h"

#include <cmath>
#include <limits>

namespace rbs {

namespace {

// Edges are parallel when no digit is left.
constexpr double kNoSine = 1e-15;

double signOf(double x) {
  return x < 0.0 ? -1.0 : 1.0;
}

int largest(const Vec3& v) {
  const int first = v[1] > v[0] ? 1 : 0;
  return v[2] > v[first] ? 2 : first;
}

// The direction at right angles to two nearly parallel unit vectors. What cancellation has left in their
// cross product is taken out again, twice.
Vec3 acrossBoth(const Vec3& u, const Vec3& v) {
  Vec3 n = u.cross(v).normalized();
  for (int k = 0; k < 2; ++k) {
    n -= n.dot(u) * u;
    n -= n.dot(v) * v;
    n.normalize();
  }
  return n;
}

}  // namespace

std::optional<BoxAxis> farthestAxis(const Vec3& half_a, const Vec3& half_b, const RelativePose& X_AB,
                                    double margin) {
  const Mat3& R = X_AB.R_AB;
  const Vec3& p = X_AB.p_AB;
  const Mat3 S = R.cwiseAbs();
  const double rounding = kRounding * (half_a.sum() + half_b.sum());

  const Vec3 along_a = p.cwiseAbs() - half_a - S * half_b;
  const int face_a = largest(along_a);
  const double best_a = along_a[face_a];
  if (best_a > margin) return std::nullopt;

  const Vec3 p_B = R.transpose() * p;
  const Vec3 along_b = p_B.cwiseAbs() - half_b - S.transpose() * half_a;
  const int face_b = largest(along_b);
  const double best_b = along_b[face_b];
  if (best_b > margin) return std::nullopt;

  double best = best_a;
  int edge_a = -1, edge_b = -1;
  const bool face_of_b = best_b > best_a + rounding;
  if (face_of_b) best = best_b;

  // l = e_i x R_j has the components 0 along i, -R_kj along i + 1 and R_(i+1)j along k = i + 2. Dividing by
  // its length only moves the value away from zero, which settles most axes without the root.
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double unscaled =
          std::abs(p[i2] * R(i1, j) - p[i1] * R(i2, j)) -
          (half_a[i1] * S(i2, j) + half_a[i2] * S(i1, j) + half_b[j1] * S(i, j2) + half_b[j2] * S(i, j1));
      if (unscaled < 0.0 && unscaled <= best) continue;
      const double squared = R(i1, j) * R(i1, j) + R(i2, j) * R(i2, j);
      double separation, noise;
      if (squared > kParallel) {
        const double length = std::sqrt(squared);
        separation = unscaled / length, noise = rounding / length;
      } else if (squared > kNoSine * kNoSine) {
        // What has lost digits can still tell most axes that are farther back.
        const double lost = 4.0 * (rounding + kRounding * p.lpNorm<1>());
        if (unscaled + lost <= best * std::sqrt(squared)) continue;
        const Vec3 l = acrossBoth(Vec3::Unit(i), R.col(j));
        separation =
            std::abs(l.dot(p)) - l.cwiseAbs().dot(half_a) - (R.transpose() * l).cwiseAbs().dot(half_b);
        noise = rounding;
      } else {
        continue;
      }
      if (separation - noise > margin) return std::nullopt;
      if (separation - noise > best) best = separation, edge_a = i, edge_b = j;
    }
  }

  Vec3 n;
  if (edge_a >= 0)
    n = acrossBoth(Vec3::Unit(edge_a), R.col(edge_b));
  else if (face_of_b)
    n = R.col(face_b);
  else
    n = Vec3::Unit(face_a);
  return BoxAxis{best, signOf(n.dot(p)) * n, edge_a, edge_b};
}

}  // namespace rbs

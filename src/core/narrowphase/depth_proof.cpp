// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/depth_proof.h"

#include "base/algebra.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

// A quadratic form on the plane of two unit vectors p and q.
struct Form {
  double pp = 0.0, pq = 0.0, qq = 0.0;

  void add(double weight, const Vec3& u, const Vec3& p, const Vec3& q) {
    const double up = u.dot(p), uq = u.dot(q);
    pp += weight * up * up, pq += weight * up * uq, qq += weight * uq * uq;
  }
  double least() const { return 0.5 * (pp + qq - std::hypot(pp - qq, 2.0 * pq)); }
};

// The least 1 / sin^3 of the angle to `axis` within `angle` of n; 0 for no axis.
double spread(const Vec3& n, const Vec3& axis, double angle) {
  if (axis.isZero(0.0)) return 0.0;
  const double across = n.cross(axis).norm(), along = std::abs(n.dot(axis));
  const double turned = std::sin(angle), left = std::cos(angle);
  if (along * left <= across * turned) return 1.0;  // at right angles to the axis
  const double sine = across * left + along * turned;
  return 1.0 / (sine * sine * sine);
}

// From the nearest point of a triangle to its boundary.
double marginOf(const Simplex& triangle) {
  const Vec3 &p = triangle.points[0].w, &q = triangle.points[1].w, &r = triangle.points[2].w;
  const double a = (r - q).norm(), b = (p - r).norm(), c = (q - p).norm(),
               area2 = (q - p).cross(r - p).norm();
  return area2 * std::min({triangle.weight[0] / a, triangle.weight[1] / b, triangle.weight[2] / c});
}

// Whether c + 2 g T + d T^2 >= 0 for all T from 0 to `turn`.
bool holds(double c, double g, double d, double turn) {
  if (!(c >= 0.0)) return false;
  if (d > 0.0 && g < 0.0 && -g < d * turn) return c * d >= g * g;
  return c + turn * (2.0 * g + turn * d) >= 0.0;
}

}  // namespace

bool provesDepth(const Finished& finished, double height, double depth, double angle, double rounding) {
  const Simplex& nearest = finished.nearest;
  const Vec3& n = finished.n;
  for (int k = 0; k < nearest.size; ++k)
    if (n.dot(nearest.points[k].w) < height - rounding) return false;
  const double turn = std::tan(0.5 * angle), above = height - depth + rounding, sum = height + depth;
  if (nearest.size == 3 || finished.margin > 0.0)
    return holds(above, nearest.size == 3 ? marginOf(nearest) : finished.margin, -sum, turn);
  if (nearest.size != 1 && nearest.size != 2) return false;
  const double bend_a = spread(n, finished.axis_a, angle), bend_b = spread(n, finished.axis_b, angle);
  const auto form = [&](double radius_a, double radius_b, const Vec3& p, const Vec3& q) {
    Form form;
    form.add(radius_a * bend_a, finished.axis_a, p, q);
    form.add(radius_b * bend_b, finished.axis_b, p, q);
    return form;
  };
  std::array<double, 2> radius_a, radius_b;
  for (int k = 0; k < nearest.size; ++k) {
    radius_a[k] = nearest.points[k].a.head<2>().norm();
    radius_b[k] = nearest.points[k].b_B.head<2>().norm();
  }
  if (nearest.size == 1) {
    const auto [p, q] = tangents(n);
    const Vec3& w = nearest.points[0].w;
    const double off = std::hypot(p.dot(w), q.dot(w));
    return holds(above, -off, 2.0 * form(radius_a[0], radius_b[0], p, q).least() - sum, turn);
  }
  Vec3 p = nearest.points[1].w - nearest.points[0].w;
  p -= n.dot(p) * n;
  const double length = p.norm();
  if (!(length > 0.0)) return false;
  p /= length;
  const Vec3 q = n.cross(p);
  const double reach = std::min(-p.dot(nearest.points[0].w), p.dot(nearest.points[1].w));
  if (!(reach > 0.0)) return false;
  const double off = std::max(std::abs(q.dot(nearest.points[0].w)), std::abs(q.dot(nearest.points[1].w)));

  // Concave in s: the ends decide.
  const Form least = form(std::min(radius_a[0], radius_a[1]), std::min(radius_b[0], radius_b[1]), p, q);
  if (holds(above, -off, 2.0 * least.pp - sum, turn) &&
      holds(above, reach - off, -4.0 * std::abs(least.pq) - sum, turn))
    return true;
  const double weight = p.dot(nearest.points[1].w) / length;  // of the first
  const auto mean = [&](const std::array<double, 2>& radius) {
    return weight * radius[0] + (1.0 - weight) * radius[1];
  };
  const Form weighted = form(mean(radius_a), mean(radius_b), p, q);
  const double small = (sum * turn + 2.0 * off - above / turn) / (2.0 * reach);  // e.w_j does for larger s
  if (!(small < 1.0)) return false;
  if (small <= 0.0) return above >= 0.0;
  return holds(above, -off,
               2.0 * (weighted.pp * (1.0 - small * small) - 2.0 * std::abs(weighted.pq) * small) - sum, turn);
}

double provenWidth(const Belt& belt, double depth, double rounding) {
  const double above = belt.height - depth + rounding, sum = belt.height + depth;
  if (!(above >= 0.0 && belt.reach > 0.0)) return 0.0;
  return 2.0 * std::atan((belt.reach + std::sqrt(belt.reach * belt.reach + above * sum)) / sum);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Spheres against solids of revolution and capsules against each other: gaps in closed form.
#include "base/algebra.h"
#include "narrowphase/convex.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

namespace {

using Vec2 = Eigen::Vector2d;

// An edge of the outline of a solid of revolution in the half-plane of the distance from the axis and the
// height along it, with its outward unit normal.
struct Edge {
  Vec2 from, to, n;

  Edge(double r0, double z0, double r1, double z1) : from(r0, z0), to(r1, z1) {
    const Vec2 along = (to - from).normalized();
    n = Vec2(along.y(), -along.x());
  }
  double height(const Vec2& p) const { return n.dot(p - from); }
};

// From a point to an outline: signed distance, and the direction in which it grows.
struct Away {
  double distance;
  Vec2 direction;
};

// Inside a convex outline the nearest point lies on the edge of the least depth, the first of several.
// Outside, one of the edges has it, at the foot of the perpendicular or at an end.
template <std::size_t count>
Away fromOutline(const Vec2& p, const std::array<Edge, count>& outline) {
  const Edge* highest = &outline[0];
  for (const Edge& edge : outline)
    if (edge.height(p) > highest->height(p)) highest = &edge;
  if (!(highest->height(p) > 0.0)) return {highest->height(p), highest->n};

  Away nearest{std::numeric_limits<double>::infinity(), highest->n};
  for (const Edge& edge : outline) {
    const Vec2 along = edge.to - edge.from;
    const double t = along.dot(p - edge.from) / along.squaredNorm();
    if (t > 0.0 && t < 1.0) {
      const double height = edge.height(p);
      if (height > 0.0 && height < nearest.distance) nearest = {height, edge.n};
    } else {
      const Vec2 offset = p - (t > 0.0 ? edge.to : edge.from);
      const double distance = offset.norm();
      if (distance > 0.0 && distance < nearest.distance) nearest = {distance, offset / distance};
    }
  }
  return nearest;
}

// A sphere about the origin of A against a solid of revolution about the z axis of B.
template <std::size_t count>
ConvexGap sphereAgainst(const std::array<Edge, count>& outline, double radius, const RelativePose& X_AB) {
  const Vec3 centre_B = X_AB.R_AB.transpose() * -X_AB.p_AB;
  const double across = std::hypot(centre_B.x(), centre_B.y());
  const Vec2 outward = across > 0.0 ? Vec2(centre_B.head<2>() / across) : Vec2(Vec2::UnitX());
  const Away away = fromOutline(Vec2(across, centre_B.z()), outline);
  const Vec2 flat = away.direction.x() * outward;
  ConvexGap gap;
  gap.n_A = X_AB.R_AB * -Vec3(flat.x(), flat.y(), away.direction.y());
  gap.distance = away.distance - radius;
  gap.middle_A = (radius + 0.5 * gap.distance) * gap.n_A;
  return gap;
}

// Points of two segments of half lengths u and v (as vectors) about 0 and p.
struct Points {
  Vec3 on_u, on_v;
  Vec3 apart;  // on_v - on_u, with what rounding leaves along the segments taken out
};

// The nearest points, and their direction; or another that proves more: where two pairs of points are equally
// near but for rounding, their directions may still differ.
class Nearest {
 public:
  Nearest(const Vec3& u, const Vec3& v, const Vec3& p)
      : u_(u), v_(v), p_(p), rounding_(kEpsilon * (u.norm() + v.norm() + 4.0 * p.norm())) {}

  void consider(const Points& points) {
    consider(points, points.apart.norm() < distance_ ? -rounding_ : rounding_);
  }
  /// Where the lines are nearest between the ends of both segments: nothing is nearer, whatever rounding
  /// says.
  void considerCrossing(const Points& points) { consider(points, -8.0 * rounding_); }
  /// Of unit length.
  void consider(const Vec3& n) { consider(n, rounding_); }
  /// Whether the direction proves the distance, up to rounding.
  bool proved() const { return separation_ >= distance_ - rounding_; }
  double distance() const { return distance_; }
  const Vec3& n() const { return n_; }
  Vec3 sum() const { return points_.on_u + points_.on_v; }

 private:
  void consider(const Points& points, double advantage) {
    const double length = points.apart.norm();
    if (length > 0.0) consider(points.apart / length, advantage);
    if (length < distance_) distance_ = length, points_ = points;
  }
  void consider(const Vec3& n, double advantage) {
    const double separation = n.dot(p_) - std::abs(n.dot(u_)) - std::abs(n.dot(v_));
    if (separation > separation_ + advantage) separation_ = separation, n_ = n;
  }

  Vec3 u_, v_, p_, n_ = Vec3::UnitX();
  Points points_{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double rounding_;
  double distance_ = std::numeric_limits<double>::infinity();
  double separation_ = -std::numeric_limits<double>::infinity();
};

// From the end at `end` to the point of the segment of half length `half` about `centre`.
Vec3 nearestOn(const Vec3& centre, const Vec3& half, const Vec3& end) {
  const double squared = half.squaredNorm();
  const double t = squared > 0.0 ? std::clamp(half.dot(end - centre) / squared, -1.0, 1.0) : 0.0;
  return centre + t * half;
}

// The first segment lies on the z axis.
// Between the ends the nearest points of the two lines are found in the frame of the first: along it, and
// along q, the part of the second that is across it. However nearly parallel they are, and however badly q
// then is known, q only has to take out as much as the second segment is wide across the first.
Nearest nearestOfAll(const Vec3& u, const Vec3& v, const Vec3& p) {
  Nearest nearest(u, v, p);
  for (const double sign : {1.0, -1.0}) {
    const Vec3 end_u = sign * u, end_v = p + sign * v;
    const Vec3 on_v = nearestOn(p, v, end_u), on_u = nearestOn(Vec3::Zero(), u, end_v);
    nearest.consider({end_u, on_v, on_v - end_u});
    nearest.consider({on_u, end_v, end_v - on_u});
  }

  const Vec3 across(v.x(), v.y(), 0.0);
  const double width = across.norm();
  Vec3 n = Vec3::UnitX();  // at right angles to both, for axes that meet
  if (width > 0.0) {
    const Vec3 q = across / width;
    n = Vec3(-q.y(), q.x(), 0.0);
    const double y = -q.dot(p), t = y / width, s = p.z() + t * v.z();
    if (std::abs(t) < 1.0 && std::abs(s) < u.z()) {
      const Vec3 apart = Vec3(p.x(), p.y(), 0.0) + y * q;
      // Their normal is known better than what lies between them where the segments are wider than apart.
      const bool wide = apart.squaredNorm() < width * width;
      nearest.considerCrossing({Vec3(0.0, 0.0, s), p + t * v, wide ? Vec3(n.dot(apart) * n) : apart});
    }
  }
  nearest.consider(n);
  nearest.consider(-n);
  return nearest;
}

// The same where the segments are far from parallel and nothing is nearly as near; else what it finds may not
// be proved. The point of the second line nearest to the first, held between the ends, has a nearest point on
// the first segment; where that is an end, it has one on the second. (C. Ericson, Real-Time Collision
// Detection, 2005, 5.1.9.)
Nearest nearestByClamping(const Vec3& u, const Vec3& v, const Vec3& p) {
  Nearest nearest(u, v, p);
  const double squared = v.squaredNorm(), across = v.x() * v.x() + v.y() * v.y();
  if (!(across > kParallel * squared)) return nearest;
  const double crossing = -(v.x() * p.x() + v.y() * p.y()) / across;
  double t = std::clamp(crossing, -1.0, 1.0);
  const double beside = p.z() + t * v.z(), s = std::clamp(beside, -u.z(), u.z());
  const Vec3 on_u(0.0, 0.0, s);
  if (s != beside) t = std::clamp(v.dot(on_u - p) / squared, -1.0, 1.0);
  const Vec3 on_v = p + t * v;
  Vec3 apart = on_v - on_u;
  if (t == crossing && s == beside) {
    const Vec3 n(-v.y(), v.x(), 0.0);
    apart = n.dot(p) / across * n;
  }
  nearest.consider({on_u, on_v, apart});
  return nearest;
}

}  // namespace

ConvexGap convexGap(const Sphere& a, const Capsule& b, const RelativePose& X_AB) {
  const Vec3 centre_B = X_AB.R_AB.transpose() * -X_AB.p_AB;
  const Vec3 offset_B = centre_B - Vec3(0.0, 0.0, std::clamp(centre_B.z(), -b.half_length, b.half_length));
  const double distance = offset_B.norm();
  ConvexGap gap;
  gap.n_A = X_AB.R_AB * (distance > 0.0 ? Vec3(offset_B / -distance) : Vec3(-Vec3::UnitX()));
  gap.distance = distance - a.radius - b.radius;
  gap.middle_A = (a.radius + 0.5 * gap.distance) * gap.n_A;
  return gap;
}

ConvexGap convexGap(const Sphere& a, const Cylinder& b, const RelativePose& X_AB) {
  const double r = b.radius, h = b.half_length;
  return sphereAgainst(std::array{Edge(r, -h, r, h), Edge(r, h, 0.0, h), Edge(0.0, -h, r, -h)}, a.radius,
                       X_AB);
}

ConvexGap convexGap(const Sphere& a, const Cone& b, const RelativePose& X_AB) {
  const double r = b.radius, base = -0.25 * b.height, apex = 0.75 * b.height;
  return sphereAgainst(std::array{Edge(r, base, 0.0, apex), Edge(0.0, base, r, base)}, a.radius, X_AB);
}

ConvexGap convexGap(const Capsule& a, const Capsule& b, const RelativePose& X_AB) {
  const Vec3 u(0.0, 0.0, a.half_length), v = b.half_length * X_AB.R_AB.col(2);
  Nearest nearest = nearestByClamping(u, v, X_AB.p_AB);
  if (!nearest.proved()) nearest = nearestOfAll(u, v, X_AB.p_AB);
  ConvexGap gap;
  gap.n_A = nearest.n();
  gap.distance = nearest.distance() - a.radius - b.radius;
  gap.middle_A = 0.5 * (nearest.sum() + (a.radius - b.radius) * gap.n_A);
  return gap;
}

}  // namespace rbs

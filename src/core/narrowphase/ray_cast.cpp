// SPDX-License-Identifier: BSD-3-Clause
// The part of a ray inside a convex set is an interval, and inside the common part of several sets the common
// part of their intervals. So a shape is cut out of the ray by half-spaces, a round side or a ball. A
// capsule, which is no such common part, goes by its support function, and so may any new shape.
#include "narrowphase/ray_cast.h"

#include <cmath>

namespace rbs {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The part of a ray that is left, and the normal where it begins.
struct Span {
  double enter = -kInfinity, leave = kInfinity;
  Vec3 n_B = Vec3::Zero();

  void cut(double from, double to, const Vec3& normal) {
    if (from > enter) enter = from, n_B = normal;
    leave = std::min(leave, to);
  }
  void cutAll() { leave = -kInfinity; }
};

struct LocalRay {
  Vec3 origin, d;
  Vec3 at(double t) const { return origin + t * d; }
};

// The half-space n.x <= offset.
void cutByHalfSpace(Span& span, const LocalRay& ray, const Vec3& n, double offset) {
  const double height = n.dot(ray.origin) - offset, slope = n.dot(ray.d);
  if (slope < 0.0)
    span.cut(-height / slope, kInfinity, n);
  else if (slope > 0.0)
    span.cut(-kInfinity, -height / slope, n);
  else if (height > 0.0)
    span.cutAll();
}

// The ball of this radius about the origin: about the middle of the chord the roots lose no digits, however
// far the ray comes from (E. Haines et al., "Precision improvements for ray/sphere intersection", Ray Tracing
// Gems, 2019).
void cutByBall(Span& span, const LocalRay& ray, double radius) {
  const double middle = -ray.origin.dot(ray.d), nearest = ray.at(middle).norm();
  const double squared = (radius - nearest) * (radius + nearest);
  if (!(squared >= 0.0)) return span.cutAll();
  const double half = std::sqrt(squared);
  span.cut(middle - half, middle + half, ray.at(middle - half).normalized());
}

Span spanOf(const Sphere& sphere, const LocalRay& ray) {
  Span span;
  cutByBall(span, ray, sphere.radius);
  return span;
}

Span spanOf(const Box& box, const LocalRay& ray) {
  Span span;
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) cutByHalfSpace(span, ray, sign * Vec3::Unit(k), 0.5 * box.size[k]);
  return span;
}

Span spanOf(const Plane& /*plane*/, const LocalRay& ray) {
  Span span;
  cutByHalfSpace(span, ray, Vec3::UnitZ(), 0.0);
  return span;
}

Span spanOf(const Cylinder& cylinder, const LocalRay& ray) {
  Span span;
  for (const double sign : {1.0, -1.0}) cutByHalfSpace(span, ray, sign * Vec3::UnitZ(), cylinder.half_length);
  const Vec3 origin(ray.origin.x(), ray.origin.y(), 0.0), across(ray.d.x(), ray.d.y(), 0.0);
  const double speed = across.norm();
  if (speed > 0.0) {
    Span side;
    cutByBall(side, {origin, across / speed}, cylinder.radius);
    span.cut(side.enter / speed, side.leave / speed, side.n_B);
  } else if (origin.norm() > cylinder.radius) {
    span.cutAll();
  }
  return span;
}

// Below its apex the cone has |xy| <= k w, with w the depth under the apex. From where the ray is nearest to
// the axis, where |xy| = near, it is inside while a t² + 2 b t + c <= 0 and w >= 0. A ray flatter than the
// side (a > 0) is inside between the roots, and a steeper one beyond the root that is under the apex.
//
// A ray almost along the axis is nearest to it so far away that no digit of the cone would be left there. It
// is looked at from its origin p instead, where b gains p.d over x and y, and the discriminant b² - a c is k²
// |w d - s p|² - (p x d)², over x and y, with s the rate at which the ray sinks.
void cutByCone(Span& span, const LocalRay& ray, double k, double apex) {
  const Vec3 across(ray.d.x(), ray.d.y(), 0.0);
  const double squared = across.squaredNorm();
  const double nearest = squared > 0.0 ? -ray.origin.dot(across) / squared : 0.0;
  const bool along = !(std::abs(nearest) <= 4.0 * (ray.origin.norm() + apex));
  const double start = along ? 0.0 : nearest;
  const Vec3 from = ray.at(start);
  const double near = from.head<2>().norm(), w = apex - from.z(), sink = -ray.d.z();

  const double a = squared - k * k * sink * sink, b = (along ? from.dot(across) : 0.0) - k * k * w * sink;
  const double c = (near - k * w) * (near + k * w);
  const double turn = from.x() * across.y() - from.y() * across.x();
  const double discriminant =
      along ? k * k * (w * across - sink * from).head<2>().squaredNorm() - turn * turn
            : squared * (k * w - near) * (k * w + near) + k * k * sink * sink * near * near;
  if (!(discriminant >= 0.0)) return span.cutAll();
  const double sum = -(b + std::copysign(std::sqrt(discriminant), b));
  const double one = sum / a, other = c / sum;
  const auto normalAt = [&](double t) -> Vec3 {
    const Eigen::Vector2d out = (from + t * ray.d).head<2>();
    const double length = out.norm();
    if (length == 0.0) return Vec3::UnitZ();
    return Vec3(out.x() / length, out.y() / length, k).normalized();
  };
  if (a > 0.0) {
    if (w + sink * 0.5 * (one + other) < 0.0) return span.cutAll();
    const auto [in, out] = std::minmax(one, other);
    return span.cut(start + in, start + out, normalAt(in));
  }
  const double root = a < 0.0 && sink * one > sink * other ? one : other;
  if (w + sink * root < 0.0) return span.cutAll();
  if (sink > 0.0)
    span.cut(start + root, kInfinity, normalAt(root));
  else
    span.cut(-kInfinity, start + root, Vec3::Zero());
}

Span spanOf(const Cone& cone, const LocalRay& ray) {
  Span span;
  cutByHalfSpace(span, ray, -Vec3::UnitZ(), 0.25 * cone.height);
  cutByCone(span, ray, cone.radius / cone.height, 0.75 * cone.height);
  return span;
}

Span spanOf(const ConvexHull& hull, const LocalRay& ray) {
  Span span;
  for (const Polyhedron::Face& face : hull.polyhedron->faces)
    cutByHalfSpace(span, ray, face.normal, face.offset);
  return span;
}

// In closed form where the ray's span inside the shape is known so.
template <class ShapeB>
auto entryInto(const ShapeB& shape, const LocalRay& ray, int /*rather*/)
    -> decltype(spanOf(shape, ray), std::optional<RayEntry>()) {
  const Span span = spanOf(shape, ray);
  // A ray that falls to a plane by less than a denormal number a metre meets it nowhere.
  if (!(span.enter <= span.leave && span.leave >= 0.0 && span.enter < kInfinity)) return std::nullopt;
  if (span.enter <= 0.0) return RayEntry{0.0, -ray.d};
  return RayEntry{span.enter, span.n_B};
}

template <class ShapeB>
std::optional<RayEntry> entryInto(const ShapeB& shape, const LocalRay& ray, long /*else*/) {
  return castRayOnSupport(coreOf(shape), coreRadius(shape), ray.origin, ray.d);
}

}  // namespace

// A ray from afar is looked at from where it comes near the shape, so that what is left is of the shape's
// size.
std::optional<RayEntry> castRay(const Shape& shape, const Vec3& origin_B, const Vec3& d_B) {
  const double radius = boundingRadius(shape);
  double skipped = 0.0;
  LocalRay ray{origin_B, d_B};
  if (std::isfinite(radius)) {
    const double middle = -origin_B.dot(d_B);
    const Vec3 nearest = ray.at(middle);
    if (nearest.squaredNorm() > 1.01 * radius * radius) return std::nullopt;
    if (middle > 2.0 * radius) {
      skipped = middle - 2.0 * radius;
      ray.origin = nearest - 2.0 * radius * d_B;
    }
  }
  std::optional<RayEntry> entry = std::visit([&](const auto& s) { return entryInto(s, ray, 0); }, shape);
  if (entry) entry->distance += skipped;
  return entry;
}

}  // namespace rbs

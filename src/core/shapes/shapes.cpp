// SPDX-License-Identifier: BSD-3-Clause
// Mass properties, bounds and names of the shapes.
#include "base/number_text.h"
#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/shape.h"
#include "shapes/support.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace rbs {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

void require(bool sound, const std::string& path, const std::string& value, const std::string& allowed) {
  if (!sound) throw InvalidInput({{path, value, allowed}});
}

double extentOr(double extent, double fallback) {
  return extent == 0.0 ? fallback : extent;
}

bool isSize(double extent) {
  return extent >= Limits::min_size && extent <= Limits::max_size;
}

std::string allowedSize() {
  return numberText(Limits::min_size) + " to " + numberText(Limits::max_size) + " m, or 0 for the default";
}

bool sameNumber(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool samePoint(const Vec3& a, const Vec3& b) {
  return sameNumber(a.x(), b.x()) && sameNumber(a.y(), b.y()) && sameNumber(a.z(), b.z());
}

bool same(const Sphere& a, const Sphere& b) {
  return sameNumber(a.radius, b.radius);
}
bool same(const Box& a, const Box& b) {
  return samePoint(a.size, b.size);
}
bool same(const Plane&, const Plane&) {
  return true;
}
bool same(const Capsule& a, const Capsule& b) {
  return sameNumber(a.radius, b.radius) && sameNumber(a.half_length, b.half_length);
}
bool same(const Cylinder& a, const Cylinder& b) {
  return sameNumber(a.radius, b.radius) && sameNumber(a.half_length, b.half_length);
}
bool same(const Cone& a, const Cone& b) {
  return sameNumber(a.radius, b.radius) && sameNumber(a.height, b.height);
}
bool same(const ConvexHull& a, const ConvexHull& b) {
  if (a.polyhedron == b.polyhedron) return true;
  if (!a.polyhedron || !b.polyhedron) return false;
  const std::vector<Vec3>&p = a.polyhedron->vertices, &q = b.polyhedron->vertices;
  return std::equal(p.begin(), p.end(), q.begin(), q.end(), samePoint);
}

// Stretching along principal axes leaves them principal axes, and the centre of mass where it is: the new
// frame B is the old one.
ConvexHull stretched(const ConvexHull& hull, const Vec3& factors, const std::string& path) {
  std::vector<Vec3> points = hull.polyhedron->vertices;
  for (Vec3& p : points) p = p.cwiseProduct(factors);
  return makeHull(points, path).hull;
}

/// Bounds about the z axis, from z = low to high.
Aabb around(double radius, double low, double high) {
  return {Vec3(-radius, -radius, low), Vec3(radius, radius, high)};
}

/// Diameter and whole length of a capsule, cylinder or cone.
struct RoundSize {
  double diameter, length;
};

RoundSize roundSize(const Vec3& d, const RoundSize& fallback, const std::string& path) {
  const RoundSize size{extentOr(d.x(), fallback.diameter), extentOr(d.z(), fallback.length)};
  require(isSize(size.diameter) && isSize(size.length), path + ".size", vectorText(d),
          "a diameter in x and a whole length in z of " + allowedSize());
  require(extentOr(d.y(), size.diameter) == size.diameter, path + ".size", vectorText(d),
          "the diameter in x, and in y the same or 0: the shape is round about z");
  return size;
}

}  // namespace

std::string shapeName(const Shape& shape) {
  return kShapeNames[shape.index()];
}

ShapeTraits traitsOf(const Shape& shape) {
  ShapeTraits traits;
  const auto revolved = [&traits](double radius, bool edged) {
    traits.revolved = true;
    traits.side_radius = radius;
    traits.edged = edged;
  };
  std::visit(
      Overloaded{[&](const Sphere& s) { revolved(s.radius, false), traits.round = true; },
                 [&](const Capsule& c) { revolved(c.radius, false); },
                 [&](const Cylinder& c) { revolved(c.radius, true); },
                 [&](const Cone& c) { revolved(c.radius, true); },
                 [&](const Plane&) { traits.unbounded = true; }, [&](const Box&) { traits.edged = true; },
                 [&](const ConvexHull&) { traits.edged = true; }},
      shape);
  return traits;
}

bool sameShape(const Shape& a, const Shape& b) {
  if (a.index() != b.index()) return false;
  return std::visit([&](const auto& x) { return same(x, std::get<std::decay_t<decltype(x)>>(b)); }, a);
}

Aabb localBounds(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& s) { return around(s.radius, -s.radius, s.radius); },
                 [](const Box& box) -> Aabb {
                   return {-0.5 * box.size, 0.5 * box.size};
                 },
                 [](const Plane&) { return around(kInfinity, -kInfinity, 0.0); },
                 [](const Capsule& c) {
                   return around(c.radius, -(c.half_length + c.radius), c.half_length + c.radius);
                 },
                 [](const Cylinder& c) { return around(c.radius, -c.half_length, c.half_length); },
                 [](const Cone& c) { return around(c.radius, -0.25 * c.height, 0.75 * c.height); },
                 [](const ConvexHull& hull) { return hull.polyhedron->bounds; }},
      shape);
}

Vec3 fullExtents(const Shape& shape) {
  return std::visit(
      Overloaded{
          [](const Sphere& sphere) -> Vec3 { return Vec3::Constant(2.0 * sphere.radius); },
          [](const Box& box) -> Vec3 { return box.size; }, [](const Plane&) -> Vec3 { return Vec3::Zero(); },
          [](const Capsule& c) -> Vec3 { return 2.0 * Vec3(c.radius, c.radius, c.half_length + c.radius); },
          [](const Cylinder& c) -> Vec3 { return 2.0 * Vec3(c.radius, c.radius, c.half_length); },
          [](const Cone& c) -> Vec3 {
            return {2.0 * c.radius, 2.0 * c.radius, c.height};
          },
          [](const ConvexHull& hull) -> Vec3 {
            return hull.polyhedron->bounds.hi - hull.polyhedron->bounds.lo;
          }},
      shape);
}

Vec3 supportPoint(const Shape& shape, const Vec3& d_B) {
  return std::visit(Overloaded{[](const Plane&) -> Vec3 { return Vec3::Zero(); },
                               [&](const auto& convex) -> Vec3 {
                                 const double radius = coreRadius(convex);
                                 const Vec3 core = coreOf(convex)(d_B);
                                 return radius > 0.0 ? Vec3(core + radius * d_B.stableNormalized()) : core;
                               }},
                    shape);
}

double reach(const Shape& shape, const Vec3& d_B) {
  if (!std::holds_alternative<Plane>(shape)) return d_B.dot(supportPoint(shape, d_B));
  return d_B.x() == 0.0 && d_B.y() == 0.0 && d_B.z() > 0.0 ? 0.0 : kInfinity;
}

Shape makeShape(const std::string& name, const Vec3& full_extents, const std::string& path) {
  const Vec3& d = full_extents;
  if (name == "sphere") {
    const double diameter = extentOr(d.x(), 2.0 * Sphere{}.radius);
    require(isSize(diameter), path + ".size", vectorText(d), "a diameter of " + allowedSize());
    require(extentOr(d.y(), diameter) == diameter && extentOr(d.z(), diameter) == diameter, path + ".size",
            vectorText(d), "the diameter in x, and in y and z the same or 0");
    return Sphere{0.5 * diameter};
  }
  if (name == "box") {
    const Vec3 fallback = Box{}.size;
    const Vec3 size(extentOr(d.x(), fallback.x()), extentOr(d.y(), fallback.y()),
                    extentOr(d.z(), fallback.z()));
    require(isSize(size.x()) && isSize(size.y()) && isSize(size.z()), path + ".size", vectorText(d),
            "edges of " + allowedSize());
    return Box{size};
  }
  if (name == "capsule") {
    const double diameter = extentOr(d.x(), 2.0 * Capsule{}.radius);
    const RoundSize size = roundSize(d, {diameter, 2.0 * diameter}, path);
    require(size.length >= size.diameter, path + ".size", vectorText(d),
            "a whole length in z of at least the diameter in x: the ends are round");
    return Capsule{0.5 * size.diameter, 0.5 * size.length - 0.5 * size.diameter};
  }
  if (name == "cylinder") {
    const RoundSize size = roundSize(d, {2.0 * Cylinder{}.radius, 2.0 * Cylinder{}.half_length}, path);
    return Cylinder{0.5 * size.diameter, 0.5 * size.length};
  }
  if (name == "cone") {
    const RoundSize size = roundSize(d, {2.0 * Cone{}.radius, Cone{}.height}, path);
    return Cone{0.5 * size.diameter, size.length};
  }
  require(name == "plane", path + ".shape", quoted(name),
          "sphere, box, plane, capsule, cylinder, cone or hull");
  require(d.isZero(0.0), path + ".size", vectorText(d), "nothing: a plane has no size");
  return Plane{};
}

Shape scaled(const Shape& shape, double factor) {
  return std::visit(Overloaded{[&](const Sphere& sphere) -> Shape { return Sphere{sphere.radius * factor}; },
                               [&](const Box& box) -> Shape { return Box{box.size * factor}; },
                               [](const Plane& plane) -> Shape { return plane; },
                               [&](const Capsule& c) -> Shape {
                                 return Capsule{c.radius * factor, c.half_length * factor};
                               },
                               [&](const Cylinder& c) -> Shape {
                                 return Cylinder{c.radius * factor, c.half_length * factor};
                               },
                               [&](const Cone& c) -> Shape {
                                 return Cone{c.radius * factor, c.height * factor};
                               },
                               [&](const ConvexHull& hull) -> Shape {
                                 return stretched(hull, Vec3::Constant(factor), "shape");
                               }},
                    shape);
}

Shape resized(const Shape& shape, const Vec3& full_extents, const std::string& path) {
  const Vec3 old = fullExtents(shape);
  Vec3 size = full_extents;
  const auto demand = [&](bool sound, const std::string& allowed) {
    require(sound, path + ".size", vectorText(full_extents), allowed);
  };
  demand(!std::holds_alternative<Plane>(shape), "nothing: a plane has no size");
  demand(size.allFinite() && size.minCoeff() >= 0.0 && size.maxCoeff() > 0.0,
         "finite extents, m; one of 0 stays as it is, but not all of them");
  if (std::holds_alternative<Sphere>(shape)) {
    demand(size.x() > 0.0, "the diameter in x, and in y and z the same or 0");
    return makeShape("sphere", size, path);
  }
  const auto* hull = std::get_if<ConvexHull>(&shape);
  const bool is_round = traitsOf(shape).revolved;
  if (size.x() == 0.0) size.x() = old.x();
  if (size.y() == 0.0) size.y() = is_round ? size.x() : old.y();
  if (size.z() == 0.0) size.z() = old.z();
  if (!hull) return makeShape(shapeName(shape), size, path);
  demand(isSize(size.x()) && isSize(size.y()) && isSize(size.z()), "extents of " + allowedSize());
  return stretched(*hull, size.cwiseQuotient(old), path + ".size");
}

double volume(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& s) { return 4.0 / 3.0 * kPi * s.radius * s.radius * s.radius; },
                 [](const Box& box) { return box.size.x() * box.size.y() * box.size.z(); },
                 [](const Plane&) { return 0.0; },
                 [](const Capsule& c) {
                   return kPi * c.radius * c.radius * (2.0 * c.half_length + 4.0 / 3.0 * c.radius);
                 },
                 [](const Cylinder& c) { return kPi * c.radius * c.radius * (2.0 * c.half_length); },
                 [](const Cone& c) { return kPi / 3.0 * c.radius * c.radius * c.height; },
                 [](const ConvexHull& hull) { return hull.polyhedron->volume; }},
      shape);
}

double surfaceArea(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& s) { return 4.0 * kPi * s.radius * s.radius; },
                 [](const Box& box) {
                   const Vec3& d = box.size;
                   return 2.0 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
                 },
                 [](const Plane&) { return kInfinity; },
                 [](const Capsule& c) { return 4.0 * kPi * c.radius * (c.half_length + c.radius); },
                 [](const Cylinder& c) { return 2.0 * kPi * c.radius * (2.0 * c.half_length + c.radius); },
                 [](const Cone& c) { return kPi * c.radius * (c.radius + std::hypot(c.radius, c.height)); },
                 [](const ConvexHull& hull) { return hull.polyhedron->area; }},
      shape);
}

// Of a solid of even density. Ball of radius r: 2/5 r² about every axis. Box of edges a, b, c: the
// integral of y² + z² over the box is m (b² + c²) / 12 about x, and so on in turn.
//
// The solids of revolution: discs of radius s(z) have s²/2 about z and s²/4 + z² across it for each unit of
// mass. A cylinder of half length l gets r²/2 and r²/4 + l²/3; a cone of height h, about its centre of mass,
// 3/10 r² and 3/20 r² + 3/80 h². A capsule is a cylinder and two halves of a ball, each of which has its
// centre of mass 3/8 r beyond the end and so 2/5 r² + l² + 3/4 l r across the axis about the middle.
Vec3 momentsPerMass(const Shape& shape) {
  return std::visit(
      Overloaded{
          [](const Sphere& s) -> Vec3 { return Vec3::Constant(0.4 * s.radius * s.radius); },
          [](const Box& box) -> Vec3 {
            const Vec3 squares = box.size.cwiseAbs2();
            return Vec3(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y()) /
                   12.0;
          },
          [](const Plane&) -> Vec3 { return Vec3::Zero(); },
          [](const Capsule& c) -> Vec3 {
            const double r = c.radius, l = c.half_length;
            const double straight = l / (l + 2.0 / 3.0 * r), ends = 2.0 / 3.0 * r / (l + 2.0 / 3.0 * r);
            const double along = r * r * (0.5 * straight + 0.4 * ends);
            const double across =
                straight * (0.25 * r * r + l * l / 3.0) + ends * (0.4 * r * r + l * l + 0.75 * l * r);
            return {across, across, along};
          },
          [](const Cylinder& c) -> Vec3 {
            const double r = c.radius, l = c.half_length;
            const double across = 0.25 * r * r + l * l / 3.0;
            return {across, across, 0.5 * r * r};
          },
          [](const Cone& c) -> Vec3 {
            const double r = c.radius, h = c.height;
            const double across = 0.15 * r * r + 0.0375 * h * h;
            return {across, across, 0.3 * r * r};
          },
          [](const ConvexHull& hull) -> Vec3 { return hull.polyhedron->moments_per_mass; }},
      shape);
}

double boundingRadius(const Shape& shape) {
  return std::visit(
      Overloaded{
          [](const Sphere& sphere) { return sphere.radius; },
          [](const Box& box) { return 0.5 * box.size.norm(); }, [](const Plane&) { return kInfinity; },
          [](const Capsule& c) { return c.half_length + c.radius; },
          [](const Cylinder& c) { return std::hypot(c.radius, c.half_length); },
          [](const Cone& c) { return std::max(0.75 * c.height, std::hypot(c.radius, 0.25 * c.height)); },
          [](const ConvexHull& hull) { return hull.polyhedron->bounding_radius; }},
      shape);
}

// The mantle of a cone is 3/4 h r / sqrt(r² + h²) away from its centre of mass.
double innerRadius(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& sphere) { return sphere.radius; },
                 [](const Box& box) { return 0.5 * box.size.minCoeff(); },
                 [](const Plane&) { return kInfinity; }, [](const Capsule& c) { return c.radius; },
                 [](const Cylinder& c) { return std::min(c.radius, c.half_length); },
                 [](const Cone& c) {
                   return c.height * std::min(0.25, 0.75 * c.radius / std::hypot(c.radius, c.height));
                 },
                 [](const ConvexHull& hull) { return hull.polyhedron->inner_radius; }},
      shape);
}

double characteristicLength(const Shape& shape) {
  return std::holds_alternative<Plane>(shape) ? kInfinity : fullExtents(shape).minCoeff();
}

}  // namespace rbs

// Mass properties, bounds and names of the shapes.
#include "number_text.h"
#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/shape.h"

#include <cmath>
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

}  // namespace

std::string shapeName(const Shape& shape) {
  return std::visit(Overloaded{[](const Sphere&) { return "sphere"; }, [](const Box&) { return "box"; },
                               [](const Plane&) { return "plane"; }},
                    shape);
}

Vec3 fullExtents(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& sphere) -> Vec3 { return Vec3::Constant(2.0 * sphere.radius); },
                 [](const Box& box) -> Vec3 { return box.size; },
                 [](const Plane&) -> Vec3 { return Vec3::Zero(); }},
      shape);
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
  require(name == "plane", path + ".shape", "'" + name + "'", "sphere, box or plane");
  require(d.isZero(0.0), path + ".size", vectorText(d), "nothing: a plane has no size");
  return Plane{};
}

Shape scaled(const Shape& shape, double factor) {
  return std::visit(Overloaded{[&](const Sphere& sphere) -> Shape { return Sphere{sphere.radius * factor}; },
                               [&](const Box& box) -> Shape { return Box{box.size * factor}; },
                               [](const Plane& plane) -> Shape { return plane; }},
                    shape);
}

double volume(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& s) { return 4.0 / 3.0 * kPi * s.radius * s.radius * s.radius; },
                 [](const Box& box) { return box.size.x() * box.size.y() * box.size.z(); },
                 [](const Plane&) { return 0.0; }},
      shape);
}

// Of a solid of even density. Ball of radius r: 2/5 r² about every axis. Box of edges a, b, c: the
// integral of y² + z² over the box is m (b² + c²) / 12 about x, and so on in turn.
Vec3 momentsPerMass(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& s) -> Vec3 { return Vec3::Constant(0.4 * s.radius * s.radius); },
                 [](const Box& box) -> Vec3 {
                   const Vec3 squares = box.size.cwiseAbs2();
                   return Vec3(squares.y() + squares.z(), squares.z() + squares.x(),
                               squares.x() + squares.y()) /
                          12.0;
                 },
                 [](const Plane&) -> Vec3 { return Vec3::Zero(); }},
      shape);
}

double boundingRadius(const Shape& shape) {
  return std::visit(Overloaded{[](const Sphere& sphere) { return sphere.radius; },
                               [](const Box& box) { return 0.5 * box.size.norm(); },
                               [](const Plane&) { return kInfinity; }},
                    shape);
}

double innerRadius(const Shape& shape) {
  return 0.5 * characteristicLength(shape);
}

double characteristicLength(const Shape& shape) {
  return std::visit(
      Overloaded{[](const Sphere& sphere) { return 2.0 * sphere.radius; },
                 [](const Box& box) { return box.size.minCoeff(); }, [](const Plane&) { return kInfinity; }},
      shape);
}

}  // namespace rbs

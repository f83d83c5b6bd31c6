// The shapes a body can have, and what the rest of the core asks of a shape.
//
// A shape is described in its body's frame B, whose origin is the centre of mass and whose axes are
// the principal axes of inertia.
#pragma once

#include "rigid_body_sim/types.h"

#include <string>
#include <utility>
#include <variant>

namespace rbs {

/// A ball about the origin of B.
struct Sphere {
  double radius = 0.25;  ///< m, > 0
};

/// A box about the origin of B, edges along the axes of B.
struct Box {
  Vec3 size = Vec3::Constant(0.5);  ///< full edge lengths, m, each > 0
};

/// The half-space z <= 0 of B: a wall or floor without end. Never dynamic.
struct Plane {};

using Shape = std::variant<Sphere, Box, Plane>;

/// "sphere", "box" or "plane".
std::string shapeName(const Shape& shape);

/// Full extents along the axes of B, m: (d, d, d) for a sphere; zero for a plane.
Vec3 fullExtents(const Shape& shape);

/// The shape of this name with these full extents. A sphere takes its diameter from x; y and z must
/// equal x or be 0. A plane takes no size. An extent of 0 means the default. Throws InvalidInput for
/// an unknown name or a bad size, with `path` in front.
Shape makeShape(const std::string& name, const Vec3& full_extents, const std::string& path);

/// The same shape, `factor` times as large. A plane stays what it is.
Shape scaled(const Shape& shape, double factor);

/// m³; 0 for a plane.
double volume(const Shape& shape);

/// Principal moments of inertia about the origin of B, divided by the mass, m²; 0 for a plane.
Vec3 momentsPerMass(const Shape& shape);

/// Radius of the smallest ball about the origin of B that holds the shape, m; infinite for a plane.
double boundingRadius(const Shape& shape);

/// Radius of the largest ball about the origin of B inside the shape, m; infinite for a plane.
double innerRadius(const Shape& shape);

/// The length scale L of a shape, m: its smallest full extent; infinite for a plane.
double characteristicLength(const Shape& shape);

}  // namespace rbs

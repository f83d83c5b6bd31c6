// SPDX-License-Identifier: BSD-3-Clause
// The shapes that a body can have, and their geometry: extents, support points, volume, inertia.
//
// A shape is described in its body's frame B, whose origin is the centre of mass and whose axes are
// the principal axes of inertia. All shapes are convex.
#pragma once

#include "rigid_body_sim/polyhedron.h"
#include "rigid_body_sim/types.h"

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

/// All points within `radius` of a segment on the z axis of B, about its origin.
struct Capsule {
  double radius = 0.125;       ///< m, > 0
  double half_length = 0.125;  ///< half the length of the segment, m, >= 0; 0 is a ball
};

/// A cylinder about the z axis and the origin of B.
struct Cylinder {
  double radius = 0.25;       ///< m, > 0
  double half_length = 0.25;  ///< half the length along z, m, > 0
};

/// A cone about the z axis of B, with its apex at z = 3/4 of its height and its base at -1/4.
struct Cone {
  double radius = 0.25;  ///< radius of the base, m, > 0
  double height = 0.5;   ///< distance of the apex from the base, m, > 0
};

/// The convex hull of a set of points; see makeHull(). All copies of the shape share one polyhedron.
struct ConvexHull {
  std::shared_ptr<const Polyhedron> polyhedron;  ///< the solid; must not be null in a body
};

/// The shape of a body, in its body frame B. All shapes are convex. Extents are Limits::min_size to
/// Limits::max_size.
using Shape = std::variant<Sphere, Box, Capsule, Cylinder, Cone, ConvexHull, Plane>;

/// The names of the alternatives of Shape, in their order.
inline constexpr std::array<const char*, std::variant_size_v<Shape>> kShapeNames{
    "sphere", "box", "capsule", "cylinder", "cone", "hull", "plane"};

/// What is asked of a shape whatever its kind. Code that treats shapes differently goes by these.
struct ShapeTraits {
  bool round = false;        ///< a ball: it looks the same however it is turned
  bool revolved = false;     ///< bounded, and the same however it is turned about the z axis of B
  bool unbounded = false;    ///< a half-space: without size, volume and mass
  bool edged = false;        ///< it has edges, or a rim
  double side_radius = 0.0;  ///< radius of its round side about the z axis of B, m; 0 without one
};

/// The traits of a shape. Costs a few instructions.
ShapeTraits traitsOf(const Shape& shape);

/// "sphere", "box", "plane", "capsule", "cylinder", "cone" or "hull".
std::string shapeName(const Shape& shape);

/// Whether two shapes are of one kind and one size, bit for bit. Two hulls are compared by their vertices.
bool sameShape(const Shape& a, const Shape& b);

/// The bounding box in B, m. That of a cone or a hull is not symmetric about the origin. That of a plane is
/// infinite, but for its upper bound of 0 along z.
Aabb localBounds(const Shape& shape);

/// Full extents along the axes of B, m: (d, d, d) for a sphere; zero for a plane.
Vec3 fullExtents(const Shape& shape);

/// The point of the shape that is farthest along d_B, in B, m. d_B has any length above 0. Not for a plane,
/// which has no such point: zero.
Vec3 supportPoint(const Shape& shape, const Vec3& d_B);

/// The largest d_B.x over the points x of the shape: how far it reaches along d_B, m for a unit d_B. Infinite
/// for a plane, but 0 along its outward normal, +z.
double reach(const Shape& shape, const Vec3& d_B);

/// The shape of this name with these full extents, m. A sphere takes its diameter from x; y and z must equal
/// x or be 0. Capsule, cylinder and cone take their diameter from x and their whole length from z; y must
/// equal x or be 0. A plane takes no size. An extent of 0 means the default, but the whole length of a
/// capsule is then twice its diameter. Throws InvalidInput with `path` in front for a bad size, an unknown
/// name, and "hull", which makeHull() makes.
Shape makeShape(const std::string& name, const Vec3& full_extents, const std::string& path);

/// A convex hull, and the pose of its body frame B in the frame P of the points that it was made of.
struct PlacedHull {
  ConvexHull hull;  ///< the shape, in B
  Pose X_PB;        ///< pose of B in P: p_WB is read as p_PB, m, and q_WB as q_PB

  /// The pose of B in W where P has the pose X_WP. It is X_WP bit for bit where B is P.
  Pose poseOfB(const Pose& X_WP) const;
};

/// The convex hull of points given in any frame P, m. Its body's frame B is at its centre of mass, along its
/// principal axes, chosen near those of P. Where P is such a frame, to rounding, B is P itself. Points inside
/// the hull and repeated points do not matter, nor do points that lie in a face or edge up to 1e-6 of the
/// extents. Faces that are coplanar to that are one. The vertices of a hull make the very same hull again,
/// bit for bit.
///
/// Throws InvalidInput with `path` for fewer than 4 or more than Limits::max_hull_points points, coordinates
/// that are not finite or beyond Limits::max_position, points that are all the same, on a line or in a plane
/// up to 1e-6 of their extent, and a hull of more than Limits::max_hull_vertices vertices. It also throws
/// where interruptReadingBy() ends it.
PlacedHull makeHull(const std::vector<Vec3>& points, const std::string& path);

/// The same shape, `factor` times as large. A plane stays what it is. Throws InvalidInput for a hull that
/// makeHull() refuses at that size. The sizes of other shapes are not checked.
Shape scaled(const Shape& shape, double factor);

/// The shape stretched along the axes of B to new full extents, m. An extent of 0 stays, but y follows x
/// where the shape is round about z, a sphere needs x, and not all may be 0. What is round must stay round,
/// as for makeShape(). Throws InvalidInput for a plane and for a bad size, with `path` in front.
Shape resized(const Shape& shape, const Vec3& full_extents, const std::string& path);

/// Volume, m³; 0 for a plane.
double volume(const Shape& shape);

/// Surface area, m²; infinite for a plane.
double surfaceArea(const Shape& shape);

/// Principal moments of inertia about the origin of B, divided by the mass, at uniform density, m²; 0 for a
/// plane.
Vec3 momentsPerMass(const Shape& shape);

/// Radius of the smallest ball about the origin of B that holds the shape, m; infinite for a plane.
double boundingRadius(const Shape& shape);

/// Radius of the largest ball about the origin of B inside the shape, m; infinite for a plane.
double innerRadius(const Shape& shape);

/// The length scale L of a shape, m: its smallest full extent; infinite for a plane.
double characteristicLength(const Shape& shape);

}  // namespace rbs

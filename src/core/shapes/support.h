// SPDX-License-Identifier: BSD-3-Clause
// Support functions: GJK and EPA use nothing else of a shape.
//
// A convex shape is a core (a point, a segment, a polytope, a cylinder, a cone) with a ball of some radius
// swept over it. The support function of the core returns its point farthest along d. A sphere is a point
// core with its radius, so that GJK on cores is exact for it and EPA is needed only where the cores
// themselves overlap.
#pragma once

#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <cmath>

namespace rbs {

struct PointCore {
  Vec3 operator()(const Vec3& /*direction*/) const { return Vec3::Zero(); }
};

struct BoxCore {
  Vec3 half;
  Vec3 operator()(const Vec3& direction) const {
    return {std::copysign(half.x(), direction.x()), std::copysign(half.y(), direction.y()),
            std::copysign(half.z(), direction.z())};
  }
};

/// From -half to half on the z axis.
struct SegmentCore {
  double half;
  Vec3 operator()(const Vec3& direction) const { return {0.0, 0.0, std::copysign(half, direction.z())}; }
};

/// The point of a circle about the z axis that is farthest along d; the circle's centre where d is the axis.
inline Vec3 onCircle(double radius, double z, const Vec3& direction) {
  const double across = direction.head<2>().norm();
  if (across == 0.0) return {0.0, 0.0, z};
  return {radius * (direction.x() / across), radius * (direction.y() / across), z};
}

struct CylinderCore {
  double radius, half_length;
  Vec3 operator()(const Vec3& direction) const {
    return onCircle(radius, std::copysign(half_length, direction.z()), direction);
  }
};

struct ConeCore {
  double radius, height;
  Vec3 operator()(const Vec3& direction) const {
    const double across = direction.head<2>().norm();
    if (height * direction.z() > radius * across) return {0.0, 0.0, 0.75 * height};
    return onCircle(radius, -0.25 * height, direction);
  }
};

struct PolyhedronCore {
  const Polyhedron* polyhedron;
  Vec3 operator()(const Vec3& direction) const {
    const std::vector<Vec3>& vertices = polyhedron->vertices;
    std::size_t farthest = 0;
    double most = vertices[0].dot(direction);
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      if (const double along = vertices[i].dot(direction); along > most) farthest = i, most = along;
    }
    return vertices[farthest];
  }
};

// A new convex shape joins GJK, EPA and the collision table by one line in each of these two lists.
inline PointCore coreOf(const Sphere& /*sphere*/) {
  return {};
}
inline BoxCore coreOf(const Box& box) {
  return {0.5 * box.size};
}
inline SegmentCore coreOf(const Capsule& capsule) {
  return {capsule.half_length};
}
inline CylinderCore coreOf(const Cylinder& cylinder) {
  return {cylinder.radius, cylinder.half_length};
}
inline ConeCore coreOf(const Cone& cone) {
  return {cone.radius, cone.height};
}
inline PolyhedronCore coreOf(const ConvexHull& hull) {
  return {hull.polyhedron.get()};
}

inline double coreRadius(const Sphere& sphere) {
  return sphere.radius;
}
inline double coreRadius(const Capsule& capsule) {
  return capsule.radius;
}
template <class Sharp>
double coreRadius(const Sharp& /*shape*/) {
  return 0.0;
}

/// Pose of B's frame in A's.
struct RelativePose {
  Mat3 R_AB;
  Vec3 p_AB;

  RelativePose(const Pose& X_WA, const Pose& X_WB)
      : R_AB((X_WA.q_WB.conjugate() * X_WB.q_WB).toRotationMatrix()),
        p_AB(X_WA.q_WB.conjugate() * (X_WB.p_WB - X_WA.p_WB)) {}

  /// With the digits of R_AB that the product of the orientations loses where they nearly agree. These digits
  /// decide where nearly parallel lines on round sides cross.
  static RelativePose withAllDigits(const Pose& X_WA, const Pose& X_WB) {
    RelativePose X_AB(X_WA, X_WB);
    using Real = long double;
    X_AB.R_AB =
        (X_WA.q_WB.conjugate().cast<Real>() * X_WB.q_WB.cast<Real>()).toRotationMatrix().cast<double>();
    return X_AB;
  }
};

/// A point w = a - b of the Minkowski difference A - B, and the points of A and B it comes from.
struct SupportPoint {
  Vec3 w = Vec3::Zero(), a = Vec3::Zero(), b = Vec3::Zero();
  Vec3 b_B = Vec3::Zero();  ///< b in B's frame, where it stays when B moves
  bool between = false;     ///< a or b is not a support point, but lies between corners that are
};

/// The support function of the Minkowski difference A - B of two cores, in A's frame.
template <class CoreA, class CoreB>
class CoreDifference {
 public:
  CoreDifference(const CoreA& a, const CoreB& b, const RelativePose& X_AB) : a_(a), b_(b), X_AB_(X_AB) {}

  SupportPoint operator()(const Vec3& direction) const {
    return pointOf(a_(direction), b_(X_AB_.R_AB.transpose() * -direction));
  }
  SupportPoint pointOf(const Vec3& a, const Vec3& b_B) const {
    const Vec3 b = X_AB_.p_AB + X_AB_.R_AB * b_B;
    return {a - b, a, b, b_B, false};
  }
  Vec3 centre() const { return -X_AB_.p_AB; }

 private:
  CoreA a_;
  CoreB b_;
  RelativePose X_AB_;
};

}  // namespace rbs

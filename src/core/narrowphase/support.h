// Support functions: the only thing GJK and EPA know of a shape.
//
// A convex shape is a core (a point, a segment, a polytope) with a ball of some radius swept over it. The
// core answers "which of your points is farthest along d?". A sphere is a point core with its radius, so
// that GJK on cores is exact for it and EPA is needed only where the cores themselves overlap.
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

// A new convex shape joins GJK, EPA and the collision table by one line in each of these two lists.
inline PointCore coreOf(const Sphere& /*sphere*/) {
  return {};
}
inline BoxCore coreOf(const Box& box) {
  return {0.5 * box.size};
}

inline double coreRadius(const Sphere& sphere) {
  return sphere.radius;
}
inline double coreRadius(const Box& /*box*/) {
  return 0.0;
}

/// B's frame seen from A's.
struct RelativePose {
  Mat3 R_AB;
  Vec3 p_AB;

  RelativePose(const Pose& X_WA, const Pose& X_WB)
      : R_AB((X_WA.q_WB.conjugate() * X_WB.q_WB).toRotationMatrix()),
        p_AB(X_WA.q_WB.conjugate() * (X_WB.p_WB - X_WA.p_WB)) {}
};

/// A point w = a - b of the Minkowski difference A - B, and the points of A and B it comes from.
struct SupportPoint {
  Vec3 w = Vec3::Zero(), a = Vec3::Zero(), b = Vec3::Zero();
  Vec3 b_B = Vec3::Zero();  ///< b in B's frame, where it stays when B moves
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
    return {a - b, a, b, b_B};
  }
  Vec3 centre() const { return -X_AB_.p_AB; }

 private:
  CoreA a_;
  CoreB b_;
  RelativePose X_AB_;
};

}  // namespace rbs

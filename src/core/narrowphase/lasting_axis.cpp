// SPDX-License-Identifier: BSD-3-Clause
// Let s_n(t) be the separation of two convex bodies A and B along the unit vector n,
//   s_n(t) = min over x in B(t) of n.x  -  max over x in A(t) of n.x.
// They are apart while one direction separates them: s(t) = max over n of s_n(t) > 0. The narrow phase
// returns the n of the largest s_n at one instant. Where edges or corners meet, several n share that maximum
// or nearly so, and the n of one instant says nothing about the motion: a box that slides over two flush
// tiles is separated from the second one by the vertical side of the tile as long as it has not reached it,
// and by the tops from then on. A contact with the first normal would stop the box at a joint that is none: a
// ghost collision. By Danskin's theorem (J. M. Danskin, "The theory of max-min", 1966)
//   ds/dt = max of ds_n/dt over the n that attain the maximum,
// so the two come together only when the LAST axis stops to separate them, and its n is the normal of their
// contact. J. Williams, Y. Lu, J. C. Trinkle, "A geometrically exact contact model for polytopes in
// multirigid- body simulation", J. Comput. Nonlinear Dyn. 12(2), 2017, keep all of these axes in one
// complementarity problem; here the predicted motion chooses one.
//
// The axes compared are the normal of the narrow phase and the normals of the faces that hold a point of its
// manifold. A face separates for the whole interval where s_n >= -tolerance at both its ends, with the normal
// of either: s_n is then nearly linear in between, if the interval ends before the two have turned far. Of
// several such faces the one that closes least wins. Neither a way in the air counts as closing, nor an
// overlap that there is already, or the depth to which a soft contact sinks in would. Where no face separates
// for so long, the two collide, and the normal of the narrow phase stands.
#include "narrowphase/lasting_axis.h"

#include "base/algebra.h"
#include "base/tolerances.h"
#include "narrowphase/collide.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

namespace rbs {

namespace {

// Cosine of the largest angle between two normals that are taken for one.
constexpr double kSameNormal = 1.0 - 1e-6;
// How far faces may turn, rad, until the separation along their normals is no longer nearly linear.
constexpr double kLinearTurn = 0.01;
// Rounding of a normal, as an angle.
constexpr double kNormalRounding = 1e-10;

// Outward normals of a shape, in its frame.
struct Normals {
  static constexpr int kMost = 16;
  int size = 0;
  std::array<Vec3, kMost> normals;

  void add(const Vec3& n) {
    const auto end = normals.begin() + size;
    if (size < kMost && std::find(normals.begin(), end, n) == end) normals[size++] = n;
  }
};

// The normals of the faces within `room` of a point of the surface. A round side has one where the point is.
void addFacesAt(const Box& box, const Vec3& point, double room, Normals& found) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(point[k]) >= 0.5 * box.size[k] - room)
      found.add(std::copysign(1.0, point[k]) * Vec3::Unit(k));
}

void addFacesAt(const Cylinder& cylinder, const Vec3& point, double room, Normals& found) {
  const double across = std::hypot(point.x(), point.y());
  if (std::abs(point.z()) >= cylinder.half_length - room)
    found.add(std::copysign(1.0, point.z()) * Vec3::UnitZ());
  if (across >= cylinder.radius - room) found.add({point.x() / across, point.y() / across, 0.0});
}

void addFacesAt(const Cone& cone, const Vec3& point, double room, Normals& found) {
  if (point.z() <= -0.25 * cone.height + room) found.add(-Vec3::UnitZ());
  const double across = std::hypot(point.x(), point.y()), side = std::hypot(cone.height, cone.radius);
  if (across == 0.0) return;
  const Vec3 n(cone.height / side * point.x() / across, cone.height / side * point.y() / across,
               cone.radius / side);
  if (n.z() * (point.z() - 0.75 * cone.height) + cone.height / side * across >= -room) found.add(n);
}

void addFacesAt(const ConvexHull& hull, const Vec3& point, double room, Normals& found) {
  for (const Polyhedron::Face& face : hull.polyhedron->faces)
    if (face.normal.dot(point) >= face.offset - room) found.add(face.normal);
}

template <class Smooth>
void addFacesAt(const Smooth& /*shape*/, const Vec3& /*point*/, double /*room*/, Normals& /*found*/) {}

// The normal of a face from A to B, at the two ends of the interval.
struct FaceAxis {
  Vec3 n_W, n_then_W;
};

// The two shapes at one instant.
struct PlacedPair {
  const Shape &a, &b;
  Pose X_WA, X_WB;

  double separation(const Vec3& n_W) const { return separationAlong(n_W, a, X_WA, b, X_WB); }
};

bool isPolytope(const Shape& shape) {
  return std::holds_alternative<Box>(shape) || std::holds_alternative<ConvexHull>(shape);
}

// The outward normals of the faces that hold a point of a manifold, to within a tolerance.
struct Faces {
  Normals of_a, of_b;
};

Faces facesAt(const Manifold& manifold, const PlacedPair& pair, double tolerance) {
  const double room =
      tolerance + kChainRounding * std::min(characteristicLength(pair.a), characteristicLength(pair.b));
  Faces faces;
  for (int k = 0; k < manifold.size; ++k) {
    const ManifoldPoint& point = manifold.points[k];
    const Vec3 half_W = 0.5 * point.separation * manifold.n_W;
    const Vec3 on_A = pair.X_WA.q_WB.conjugate() * (point.p_W - half_W - pair.X_WA.p_WB);
    const Vec3 on_B = pair.X_WB.q_WB.conjugate() * (point.p_W + half_W - pair.X_WB.p_WB);
    std::visit([&](const auto& shape) { addFacesAt(shape, on_A, room, faces.of_a); }, pair.a);
    std::visit([&](const auto& shape) { addFacesAt(shape, on_B, room, faces.of_b); }, pair.b);
  }
  return faces;
}

// The manifold on the face that separates the two most, of those that `isWanted` and meet where the nearest points are. Where two
// edges meet along each other, the normals of both faces of either may separate the two alike, and rounding would choose one of
// them, anew in each query. Empty where no such face separates the two by as much as the nearest axis does, to within a tolerance;
// of two that are apart, to within rounding.
template <class IsWanted>
Manifold manifoldOnFace(const Manifold& nearest, const PlacedPair& pair, double margin, double tolerance,
                        const IsWanted& isWanted) {
  const auto deepest = std::min_element(
      nearest.points.begin(), nearest.points.begin() + nearest.size,
      [](const ManifoldPoint& a, const ManifoldPoint& b) { return a.separation < b.separation; });
  Gap best{-std::numeric_limits<double>::infinity(), Vec3::Zero(), deepest->p_W, deepest->p_W};
  const auto consider = [&](const Vec3& n_W) {
    if (!isWanted(n_W)) return;
    const double separation = pair.separation(n_W);
    if (separation > best.distance) best.distance = separation, best.n_W = n_W;
  };
  const Faces faces = facesAt(nearest, pair, tolerance);
  for (int k = 0; k < faces.of_a.size; ++k) consider(pair.X_WA.q_WB * faces.of_a.normals[k]);
  for (int k = 0; k < faces.of_b.size; ++k) consider(pair.X_WB.q_WB * -faces.of_b.normals[k]);
  const double length = std::min(characteristicLength(pair.a), characteristicLength(pair.b));
  const double less = deepest->separation > 0.0 ? std::min(tolerance, kTouch * length) : tolerance;
  if (!(best.distance >= deepest->separation - less)) return {};
  return collideAlong(best, pair.a, pair.X_WA, pair.b, pair.X_WB, margin);
}

// By how much an axis closes in an interval, m, negative: what brings the two nearer than the tolerance, from
// a separation s_0 to s_1.
double closing(double s_0, double s_1, double tolerance) {
  return s_1 - std::min(s_0, tolerance);
}

// How fast the faces of a shape turn, rad/s: what is round about an axis looks the same as it spins about it.
double turningOf(const Shape& shape, const Motion& motion) {
  const ShapeTraits traits = traitsOf(shape);
  if (traits.round) return 0.0;
  if (!traits.revolved) return motion.spinBounds().w;
  return motion.twist.w_WB.cross(motion.pose.q_WB * Vec3::UnitZ()).norm();
}

}  // namespace

Manifold lastingManifold(const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b,
                         double from, double until, double margin, const LastingLimits& limits,
                         const Vec3& loaded_W, SeparatingAxis& axis) {
  const PlacedPair now{a, b, motion_a.at(from), motion_b.at(from)};
  const Manifold nearest = collide(a, now.X_WA, b, now.X_WB, margin, axis);
  if (nearest.size == 0 || !(until > from)) return nearest;

  const double turning = turningOf(a, motion_a) + turningOf(b, motion_b);
  const double time = std::min(until - from, kLinearTurn / turning), turn = time * turning;
  const auto isLoaded = [&](const Vec3& n_W) {
    return loaded_W.dot(n_W) > 0.0 && loaded_W.cross(n_W).norm() <= 2.0 * turn + kNormalRounding;
  };
  if (isLoaded(nearest.n_W)) return nearest;
  const double tolerance = limits.tolerance;
  const auto isOfLoadedFace = [&](const Vec3& n_W) { return loaded_W.dot(n_W) >= kSameNormal; };
  if (!loaded_W.isZero(0.0) && isPolytope(a) && isPolytope(b)) {
    const Manifold kept = manifoldOnFace(nearest, now, margin, tolerance, isOfLoadedFace);
    if (kept.size > 0) return kept;
  }

  const Twist twist_a = motion_a.twistAt(from), twist_b = motion_b.twistAt(from);
  const auto relativeVelocity = [&](const Vec3& p_W) -> Vec3 {
    return velocityAt(twist_b, p_W - now.X_WB.p_WB) - velocityAt(twist_a, p_W - now.X_WA.p_WB);
  };
  // Along the normal of the narrow phase the solver sees what the points do.
  double s_0 = std::numeric_limits<double>::infinity(), s_1 = s_0;
  for (int k = 0; k < nearest.size; ++k) {
    const ManifoldPoint& point = nearest.points[k];
    const Vec3 u = relativeVelocity(point.p_W);
    s_0 = std::min(s_0, point.separation);
    s_1 = std::min(s_1, point.separation + time * nearest.n_W.dot(u));
  }
  const double nearest_closing = closing(s_0, s_1, tolerance);
  if (nearest_closing >= -limits.slowest * time) return nearest;

  const PlacedPair then{a, b, motion_a.at(from + time), motion_b.at(from + time)};
  const Faces faces = facesAt(nearest, now, tolerance);
  std::array<FaceAxis, 2 * Normals::kMost> axes;
  int size = 0;
  const auto add = [&](const FaceAxis& face) {
    if (now.separation(face.n_W) >= -tolerance) axes[size++] = face;
  };
  for (int k = 0; k < faces.of_a.size; ++k)
    add({now.X_WA.q_WB * faces.of_a.normals[k], then.X_WA.q_WB * faces.of_a.normals[k]});
  for (int k = 0; k < faces.of_b.size; ++k)
    add({now.X_WB.q_WB * -faces.of_b.normals[k], then.X_WB.q_WB * -faces.of_b.normals[k]});
  const FaceAxis* chosen = nullptr;
  double least_closing = limits.closing * nearest_closing;
  for (int k = 0; k < size; ++k) {
    if (axes[k].n_W.cross(nearest.n_W).norm() <= kNormalRounding) continue;
    const double s_then = then.separation(axes[k].n_then_W);
    const double closes = closing(now.separation(axes[k].n_W), s_then, tolerance);
    if (s_then >= -tolerance && closes >= least_closing) least_closing = closes, chosen = &axes[k];
  }
  if (chosen == nullptr) return nearest;

  Manifold later = collide(a, then.X_WA, b, then.X_WB, margin);
  if (later.size == 0 || later.n_W.dot(chosen->n_then_W) < kSameNormal)
    return from + time < until ? nearest : Manifold();  // what turns on may not pass
  // Points stay with the body that moves more.
  const bool on_a = twist_a.v_WB.squaredNorm() > twist_b.v_WB.squaredNorm();
  const Pose &X_WM = on_a ? now.X_WA : now.X_WB, &X_WM_then = on_a ? then.X_WA : then.X_WB;
  later.n_W = chosen->n_W;
  const double least = now.separation(chosen->n_W);  // no two points are nearer along the axis
  for (int k = 0; k < later.size; ++k) {
    ManifoldPoint& point = later.points[k];
    point.p_W = X_WM.p_WB + X_WM.q_WB * (X_WM_then.q_WB.conjugate() * (point.p_W - X_WM_then.p_WB));
    const Vec3 u = relativeVelocity(point.p_W);
    point.separation = std::max(point.separation - time * chosen->n_W.dot(u), least);
  }
  return later;
}

}  // namespace rbs

#include "narrowphase/collide.h"

#include "narrowphase/convex.h"
#include "narrowphase/pairs.h"

#include <limits>
#include <utility>

namespace rbs {

namespace {

/// How one ordered pair of kinds of shapes meets.
struct Meeting {
  Manifold (*collide)(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin);
  Gap (*gap)(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
};

template <class A, class B>
using CollidePair = Manifold (*)(const A&, const Pose&, const B&, const Pose&, double);
template <class A, class B>
using GapPair = Gap (*)(const A&, const Pose&, const B&, const Pose&);

// Hands the alternatives of the variants to routines for them.
template <class A, class B, CollidePair<A, B> collide_pair, GapPair<A, B> gap_pair>
constexpr Meeting meeting() {
  return {[](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin) {
            return collide_pair(*std::get_if<A>(&a), X_WA, *std::get_if<B>(&b), X_WB, margin);
          },
          [](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
            return gap_pair(*std::get_if<A>(&a), X_WA, *std::get_if<B>(&b), X_WB);
          }};
}

Manifold collidePlanes(const Plane&, const Pose&, const Plane&, const Pose&, double) {
  return {};
}

Gap gapPlanes(const Plane&, const Pose&, const Plane&, const Pose&) {
  return {std::numeric_limits<double>::infinity(), Vec3::UnitZ(), Vec3::Zero(), Vec3::Zero()};
}

// Half of the table is empty: that pair is the other one with A and B swapped.
constexpr Meeting kSwapped{nullptr, nullptr};
constexpr auto kSpheres = meeting<Sphere, Sphere, collideSpheres, gapSpheres>();
constexpr auto kSphereBox = meeting<Sphere, Box, collideSphereBox, gapSphereBox>();
constexpr auto kSpherePlane = meeting<Sphere, Plane, collideSpherePlane, gapSpherePlane>();
constexpr auto kBoxes = meeting<Box, Box, collideBoxes, gapBoxes>();
constexpr auto kBoxPlane = meeting<Box, Plane, collideBoxPlane, gapBoxPlane>();
constexpr auto kPlanes = meeting<Plane, Plane, collidePlanes, gapPlanes>();
template <class A>
constexpr auto kOnPlane = meeting<A, Plane, collideConvexPlane<A>, gapConvexPlane<A>>();
template <class A, class B>
constexpr auto kConvex = meeting<A, B, collideConvex<A, B>, gapConvex<A, B>>();
using Hull = ConvexHull;

// clang-format off
constexpr Meeting kTable[][std::variant_size_v<Shape>] = {
    // with     sphere    box         plane               capsule                     cylinder                     cone                     hull
    /* sphere   */ {kSpheres, kSphereBox, kSpherePlane, kConvex<Sphere, Capsule>, kConvex<Sphere, Cylinder>, kConvex<Sphere, Cone>, kConvex<Sphere, Hull>},
    /* box      */ {kSwapped, kBoxes, kBoxPlane, kConvex<Box, Capsule>, kConvex<Box, Cylinder>, kConvex<Box, Cone>, kConvex<Box, Hull>},
    /* plane    */ {kSwapped, kSwapped, kPlanes, kSwapped, kSwapped, kSwapped, kSwapped},
    /* capsule  */ {kSwapped, kSwapped, kOnPlane<Capsule>, kConvex<Capsule, Capsule>, kConvex<Capsule, Cylinder>, kConvex<Capsule, Cone>, kConvex<Capsule, Hull>},
    /* cylinder */ {kSwapped, kSwapped, kOnPlane<Cylinder>, kSwapped, kConvex<Cylinder, Cylinder>, kConvex<Cylinder, Cone>, kConvex<Cylinder, Hull>},
    /* cone     */ {kSwapped, kSwapped, kOnPlane<Cone>, kSwapped, kSwapped, kConvex<Cone, Cone>, kConvex<Cone, Hull>},
    /* hull     */ {kSwapped, kSwapped, kOnPlane<Hull>, kSwapped, kSwapped, kSwapped, kConvex<Hull, Hull>},
};
// clang-format on
static_assert(std::size(kTable) == std::variant_size_v<Shape>, "one row for each shape");

const Meeting& meetingOf(const Shape& a, const Shape& b) {
  return kTable[a.index()][b.index()];
}

}  // namespace

Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin) {
  if (const Meeting& m = meetingOf(a, b); m.collide != nullptr) return m.collide(a, X_WA, b, X_WB, margin);
  Manifold manifold = meetingOf(b, a).collide(b, X_WB, a, X_WA, margin);
  manifold.n_W = -manifold.n_W;
  return manifold;
}

Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  if (const Meeting& m = meetingOf(a, b); m.gap != nullptr) return m.gap(a, X_WA, b, X_WB);
  Gap swapped = meetingOf(b, a).gap(b, X_WB, a, X_WA);
  swapped.n_W = -swapped.n_W;
  std::swap(swapped.p_WA, swapped.p_WB);
  return swapped;
}

}  // namespace rbs

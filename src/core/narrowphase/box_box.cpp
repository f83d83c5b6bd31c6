// SPDX-License-Identifier: BSD-3-Clause
// The manifold of two boxes.
//
// The normal is the separating axis of farthestAxis(). Where a face of a box looks along it, up to a few
// degrees, that face is the reference: the face of the other box turned most against it is clipped by the
// sides of the reference, and each corner of what remains is a point. Otherwise two edges cross in one point.
// The reference is A's face unless B's is clearly better aligned, so that boxes lying flat on each other keep
// their points while the axis wavers by rounding.
#include "narrowphase/box_axes.h"
#include "narrowphase/convex.h"
#include "narrowphase/pairs.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace rbs {

namespace {

// Below this fraction of the size, the difference of two witness points has lost its direction.
constexpr double kNoDirection = 4e-7;

// Sine of an angle below which two edges lie along each other.
constexpr double kAlong = 1e-6;

// A corner of the clipped face: place along the reference face's edges, height over it, and the edge that
// starts here: 0 to 3 of the incident face, 4 to 7 a side of the reference face.
struct Corner {
  double u, v, height;
  std::uint32_t edge;
};

struct Polygon {
  int size = 0;
  std::array<Corner, 8> corners;

  // Clipping a quadrilateral by four lines leaves at most eight corners.
  void add(const Corner& corner) {
    if (size < 8) corners[size++] = corner;
  }
};

// Keeps the part with sign * coordinate <= limit (Sutherland and Hodgman, CACM 17(1), 1974); the new edge
// is named `edge`.
template <double Corner::*coordinate>
void clip(Polygon& polygon, double sign, double limit, std::uint32_t edge) {
  std::array<double, 8> excess;
  double most = 0.0;
  for (int k = 0; k < polygon.size; ++k) {
    excess[k] = sign * (polygon.corners[k].*coordinate) - limit;
    most = std::max(most, excess[k]);
  }
  if (most == 0.0) return;
  const Polygon whole = polygon;
  polygon.size = 0;
  for (int k = 0; k < whole.size; ++k) {
    const int next = k + 1 == whole.size ? 0 : k + 1;
    const Corner &c = whole.corners[k], &d = whole.corners[next];
    const bool inside = excess[k] <= 0.0;
    if (inside) polygon.add(c);
    if (inside == (excess[next] <= 0.0)) continue;
    const double t = excess[k] / (excess[k] - excess[next]);
    polygon.add({c.u + t * (d.u - c.u), c.v + t * (d.v - c.v), c.height + t * (d.height - c.height),
                 inside ? edge : c.edge});
  }
}

// A face of a box: its axis, and which end of it.
struct Face {
  int axis;
  double sign;
  double alignment;  // cosine to the direction it was chosen for
};

Face faceAlong(const Vec3& direction) {
  const Vec3 cosines = direction.cwiseAbs();
  int axis = cosines[1] > cosines[0] ? 1 : 0;
  if (cosines[2] > cosines[axis]) axis = 2;
  return {axis, direction[axis] < 0.0 ? -1.0 : 1.0, cosines[axis]};
}

// A corner or an edge of a box: by axis, the end at which it lies; an edge lies at neither end of the axis along which it runs.
using Ends = std::array<int, 3>;

// The number of a corner or an edge, below 27.
std::uint32_t numberOf(const Ends& ends) {
  return static_cast<std::uint32_t>(9 * (ends[0] + 1) + 3 * (ends[1] + 1) + ends[2] + 1);
}

// The corner of a face with which its edge `edge` begins, as addFacePoints() goes round it.
Ends cornerOf(const Face& face, std::uint32_t edge) {
  Ends ends;
  ends[face.axis] = face.sign > 0.0 ? 1 : -1;
  ends[(face.axis + 1) % 3] = edge == 1 || edge == 2 ? 1 : -1;
  ends[(face.axis + 2) % 3] = edge >= 2 ? 1 : -1;
  return ends;
}

Ends edgeOf(const Face& face, std::uint32_t edge) {
  Ends ends = cornerOf(face, edge);
  ends[(face.axis + (edge % 2 == 0 ? 1 : 2)) % 3] = 0;
  return ends;
}

// The corner, or edge, of the reference face at which its sides number `side` (4 to 7, as in clip()) lie.
Ends endsAtSides(const Face& reference, std::initializer_list<std::uint32_t> sides) {
  Ends ends{};
  ends[reference.axis] = reference.sign > 0.0 ? 1 : -1;
  for (const std::uint32_t side : sides)
    ends[(reference.axis + (side < 6 ? 1 : 2)) % 3] = side % 2 == 0 ? 1 : -1;
  return ends;
}

// Names a point by what it is made of: a corner of A, a corner of B, or an edge of each that cross. So it does not matter which
// of the two has the reference face, nor which of its faces that is: a box that tips over one of its edges keeps the points of
// that edge, and one that comes to lie flat those that bore it before.
struct Naming {
  const Face &reference, &incident;
  bool reference_is_b;

  std::uint32_t operator()(std::uint32_t edge_in, std::uint32_t edge_out) const {
    const auto corner = [](bool of_b, const Ends& ends) { return (of_b ? 32u : 0u) + numberOf(ends); };
    if (edge_in < 4 && edge_out < 4) return corner(!reference_is_b, cornerOf(incident, edge_out));
    if (edge_in >= 4 && edge_out >= 4)
      return corner(reference_is_b, endsAtSides(reference, {edge_in, edge_out}));
    const auto [edge, side] = std::minmax(edge_in, edge_out);
    const std::uint32_t of_incident = numberOf(edgeOf(incident, edge)),
                        of_reference = numberOf(endsAtSides(reference, {side}));
    return 64u + (reference_is_b ? 27u * of_incident + of_reference : 27u * of_reference + of_incident);
  }
};

struct PlacedBox {
  Vec3 half;
  const Pose& X_W;
};

// The points of the incident box Y over the reference face of box X. `n_X` is the manifold's normal, from X
// to Y, in X's frame. A point stands for a point of Y's face and the one of X's face below it; its separation
// is how far these are apart along n_X.
void addFacePoints(Manifold& manifold, const PlacedBox& x, const PlacedBox& y, const Mat3& R_XY,
                   const Vec3& p_XY, const Vec3& n_X, const Face& reference, bool reference_is_b,
                   double margin) {
  const Vec3 up_Y = reference.sign * R_XY.row(reference.axis).transpose();
  const Face incident = faceAlong(-up_Y);
  const int k = (incident.axis + 1) % 3, l = (incident.axis + 2) % 3;
  const int u = (reference.axis + 1) % 3, v = (reference.axis + 2) % 3;
  const Vec3 centre = p_XY + incident.sign * y.half[incident.axis] * R_XY.col(incident.axis);
  const Vec3 edge_k = y.half[k] * R_XY.col(k), edge_l = y.half[l] * R_XY.col(l);

  Polygon polygon;
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    const double sk = corner == 1 || corner == 2 ? 1.0 : -1.0, sl = corner >= 2 ? 1.0 : -1.0;
    const Vec3 q = centre + sk * edge_k + sl * edge_l;
    polygon.add({q[u], q[v], reference.sign * q[reference.axis] - x.half[reference.axis], corner});
  }
  const double size_y = std::max(y.half[k], y.half[l]);
  const double limit_u = x.half[u] + kOverhang * std::min(x.half[u], size_y),
               limit_v = x.half[v] + kOverhang * std::min(x.half[v], size_y);
  clip<&Corner::u>(polygon, 1.0, limit_u, 4);
  clip<&Corner::u>(polygon, -1.0, limit_u, 5);
  clip<&Corner::v>(polygon, 1.0, limit_v, 6);
  clip<&Corner::v>(polygon, -1.0, limit_v, 7);

  const Mat3 R_WX = x.X_W.q_WB.toRotationMatrix();
  const double cosine = reference.sign * n_X[reference.axis];
  const Naming name{reference, incident, reference_is_b};
  const Vec3 outward = R_XY.col(incident.axis);
  for (int c = 0; c < polygon.size; ++c) {
    Corner corner = polygon.corners[c];
    const std::uint32_t edge_in = polygon.corners[c == 0 ? polygon.size - 1 : c - 1].edge;
    if (edge_in >= 4 && corner.edge >= 4) {
      // The sides were moved out by the overhang; a corner of the reference face is where it is.
      const Ends ends = endsAtSides(reference, {edge_in, corner.edge});
      const Vec3 q = Vec3(ends[0], ends[1], ends[2]).cwiseProduct(x.half);
      corner.u = q[u], corner.v = q[v];
      corner.height = outward.dot(centre - q) / (reference.sign * outward[reference.axis]);
    }
    const double separation = corner.height * cosine;
    if (separation > margin) continue;
    Vec3 q;
    q[u] = corner.u, q[v] = corner.v;
    q[reference.axis] = reference.sign * (x.half[reference.axis] + 0.5 * corner.height);
    manifold.add(x.X_W.p_WB + R_WX * q, separation, name(edge_in, corner.edge));
  }
}

// The nearest points of the lines of the two edges that span the axis, when both lie on the edges. With a, b the
// directions of the edges, w = b - (a.b) a the part of b across a, r from the middle of the one to that of the other, and
// |w| the sine of their angle,
//   t = -r.w / w.w,   s = r.a + t a.b
// are the places along b and a. Edges that are nearly parallel meet in a segment, and rounding would say where on it.
void addEdgePoint(Manifold& manifold, const PlacedBox& a, const PlacedBox& b, const RelativePose& X_AB,
                  const BoxAxis& axis, double margin) {
  const int i = axis.edge_a, j = axis.edge_b;
  const Vec3 n_B = X_AB.R_AB.transpose() * axis.n_A;
  Vec3 on_a = BoxCore{a.half}(axis.n_A), on_b_B = BoxCore{b.half}(-n_B);
  const std::uint32_t signs = (on_a[(i + 1) % 3] > 0.0 ? 1u : 0u) + (on_a[(i + 2) % 3] > 0.0 ? 2u : 0u) +
                              (on_b_B[(j + 1) % 3] > 0.0 ? 4u : 0u) + (on_b_B[(j + 2) % 3] > 0.0 ? 8u : 0u);
  on_a[i] = 0.0, on_b_B[j] = 0.0;
  const Vec3 on_b = X_AB.p_AB + X_AB.R_AB * on_b_B;
  const Vec3 along_b = X_AB.R_AB.col(j), r = on_b - on_a;
  Vec3 across = along_b;
  across[i] = 0.0;
  if (across.squaredNorm() < kAlong * kAlong) return;
  const double t = -r.dot(across) / across.squaredNorm(), s = r[i] + t * along_b[i];
  if (std::abs(s) > (1.0 + kOverhang) * a.half[i] || std::abs(t) > (1.0 + kOverhang) * b.half[j]) return;
  if (axis.separation > margin) return;
  const Vec3 middle_A = 0.5 * (on_a + s * Vec3::Unit(i) + on_b + t * along_b);
  manifold.add(a.X_W.p_WB + a.X_W.q_WB * middle_A, axis.separation,
               0x80000000u | ((3u * i + j) * 16u + signs));
}

// A point of A where B touches it once B is moved out along the axis.
Vec3 touchingPoint(const Box& a, const Box& b, RelativePose X_AB, const BoxAxis& axis) {
  X_AB.p_AB -= axis.separation * axis.n_A;
  const CoreDifference difference(coreOf(a), coreOf(b), X_AB);
  return gjk(difference, difference.centre()).simplex.witnessA();
}

// The points along an axis: where the faces that look along it lie over each other, else where its two edges cross. Empty where
// there are neither.
Manifold manifoldAlong(const BoxAxis& axis, const Box& box_a, const Pose& X_WA, const Box& box_b,
                       const Pose& X_WB, double margin) {
  const PlacedBox a{0.5 * box_a.size, X_WA}, b{0.5 * box_b.size, X_WB};
  const RelativePose X_AB(X_WA, X_WB);
  Manifold manifold;
  manifold.n_W = X_WA.q_WB * axis.n_A;
  const Vec3 n_B = X_AB.R_AB.transpose() * axis.n_A;
  const Face face_a = faceAlong(axis.n_A), face_b = faceAlong(-n_B);
  if (face_b.alignment > face_a.alignment + kAligned) {
    if (face_b.alignment >= 1.0 - kAligned)
      addFacePoints(manifold, b, a, X_AB.R_AB.transpose(), X_AB.R_AB.transpose() * -X_AB.p_AB, -n_B, face_b,
                    true, margin);
  } else if (face_a.alignment >= 1.0 - kAligned) {
    addFacePoints(manifold, a, b, X_AB.R_AB, X_AB.p_AB, axis.n_A, face_a, false, margin);
  }
  if (manifold.size == 0 && axis.edge_a >= 0) addEdgePoint(manifold, a, b, X_AB, axis, margin);
  return manifold;
}

}  // namespace

Manifold collidePair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin) {
  const std::optional<BoxAxis> axis =
      farthestAxis(0.5 * a.size, 0.5 * b.size, RelativePose(X_WA, X_WB), margin);
  if (!axis) return {};
  const Manifold manifold = manifoldAlong(*axis, a, X_WA, b, X_WB, margin);
  return manifold.size > 0 ? manifold : collideConvex(a, X_WA, b, X_WB, margin);
}

Manifold collideAlongPair(const ConvexGap& gap, const Box& a, const Pose& X_WA, const Box& b,
                          const Pose& X_WB, double margin) {
  return manifoldAlong({gap.distance, gap.n_A}, a, X_WA, b, X_WB, margin);
}

// Overlapping boxes are judged by their axes. So is the direction of a tiny gap, where a face or two edges
// span it: then the gap along the axis is the distance.
Gap gapPair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, const Search& search) {
  const RelativePose X_AB(X_WA, X_WB);
  const BoxAxis axis =
      *farthestAxis(0.5 * a.size, 0.5 * b.size, X_AB, std::numeric_limits<double>::infinity());
  const double size = a.size.maxCoeff() + b.size.maxCoeff();
  const auto placed = [&](double distance, const Vec3& n_A, const Vec3& middle_A) {
    return spanAbout(X_WA.p_WB + X_WA.q_WB * middle_A, distance, X_WA.q_WB * n_A);
  };
  if (axis.separation > 0.0) {
    const ConvexGap gap = convexGap(a, b, X_AB, search);
    const bool spanned =
        gap.distance <= kNoDirection * size && gap.distance <= axis.separation + 1e-15 * size;
    if (!spanned) return placed(std::max(gap.distance, axis.separation), gap.n_A, gap.middle_A);
    return placed(axis.separation, axis.n_A, gap.middle_A);
  }
  return placed(axis.separation, axis.n_A,
                touchingPoint(a, b, X_AB, axis) + 0.5 * axis.separation * axis.n_A);
}

// Boxes meet where no axis separates them; how far they are apart the axes do not say.
bool withinPair(const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB, double margin,
                Vec3& /*n_W*/) {
  if (!farthestAxis(0.5 * a.size, 0.5 * b.size, RelativePose(X_WA, X_WB), margin)) return false;
  return margin == 0.0 || gapPair(a, X_WA, b, X_WB, {}).distance <= margin;
}

}  // namespace rbs

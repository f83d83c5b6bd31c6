// SPDX-License-Identifier: BSD-3-Clause
// Refines the direction of the closest points of two shapes to its last digits, where one shape is round.
//
// GJK and EPA approach a rim by chords: the error of the direction is the square root of that of the gap. But
// they soon find the features that are closest, and then the direction is the root of a smooth equation. With
// a and b the points of the features of A and B farthest towards each other along a unit vector n, from A to
// B,
//   s(n) = n.(b - a)
// is the separation along n, and where it is stationary on the sphere, b - a is along n. A feature is a point
// or a circle, whose farthest point turns with n: for a circle of radius r about the axis u, with e the
// direction of n across u and f = u x e,
//   a = centre + r e,   da/dn = r / |n across u| f f'.
// A feature that is straight pins n: an edge or a line on a round side to a circle n.u = c, a face to a
// point. So n has two, one or no degrees of freedom, and Newton's method finds s'(n) = 0 on the sphere or on
// the circle:
//   s''(t, t) = t'(db/dn - da/dn) t - s   (on the circle, with t = u x n: ... - (b - a).(n - c u)).
// It works on either side of contact, with no loss of digits as the gap vanishes. The result is only a better
// direction for the support functions, which prove its quality.
#pragma once

#include "narrowphase/gjk.h"
#include "narrowphase/tolerances.h"

#include <type_traits>

namespace rbs {

/// The feature of a shape that may be closest to the other shape: up to three points or circles about one
/// axis, whose farthest points along n are the corners of a point, an edge or line, or a triangle; or a disc.
struct Feature {
  Vec3 axis = Vec3::UnitZ();
  int size = 0;
  std::array<Vec3, 3> centre;
  std::array<double, 3> radius{};  ///< 0: a point
  enum class Pin { None, Circle, Point } pin = Pin::None;
  Vec3 pin_axis = Vec3::UnitZ();  ///< unit; the outward normal has pin_axis.n = pin_cosine, or is pin_axis
  double pin_cosine = 0.0;

  bool isDisc() const { return pin == Pin::Point && radius[0] > 0.0; }
  void add(const Vec3& c, double r) { centre[size] = c, radius[size++] = r; }
};

/// A direction, and points of the two shapes, as many of each, that span what is nearest along it; 0 if
/// unknown. `margin` is that of Finished.
struct FeatureContact {
  Vec3 n;
  int size = 0;
  std::array<Vec3, 4> on_a, on_b;
  std::array<int, 4> corner_b{-1, -1, -1, -1};  ///< which point of the feature of B on_b is; -1: none
  bool between = false;                         ///< the points lie between corners
  bool elsewhere = false;  ///< n is what it was, or that of a disc beside which the features meet
  double margin = 0.0;
  std::array<Belt, 4> belts{};
};

/// The refined unit direction near n for two features (both in one frame, their normals outward); n itself
/// where none is found.
FeatureContact featureContactOf(const Feature& a, const Feature& b, const Vec3& n, Seek seek);

/// The features of a core that may be closest to another shape in the direction d, judged by d and by support
/// points found nearby, all in the core's frame. At most two; the first is the likelier one.
struct Features {
  int size = 0;
  std::array<Feature, 2> of;
  void add(const Feature& feature) { of[size++] = feature; }
};
Features featuresAt(const CylinderCore& core, const Vec3& d, const Vec3* points, int size);
Features featuresAt(const ConeCore& core, const Vec3& d, const Vec3* points, int size);
Features featuresAt(const SegmentCore& core, const Vec3& d, const Vec3* points, int size);
/// Of a polytope: the vertex, the edge or the face that the points span.
Features spannedBy(const Vec3& d, const Vec3* points, int size);
template <class Flat>
Features featuresAt(const Flat& /*core*/, const Vec3& d, const Vec3* points, int size) {
  return spannedBy(d, points, size);
}

template <class Core>
inline constexpr bool isRound = std::is_same_v<Core, CylinderCore> || std::is_same_v<Core, ConeCore>;

/// Refines directions of the difference of two cores.
template <class CoreA, class CoreB>
class Finish {
 public:
  static constexpr bool kRound = isRound<CoreA> || isRound<CoreB>;

  Finish(const CoreA& a, const CoreB& b, const RelativePose& X_AB) : a_(a), b_(b), X_AB_(X_AB) {}

  /// The direction near n (unit, in A's frame, from A to B) of the largest separation, given points of the
  /// features that are near.
  Finished operator()(const Vec3& n, const SupportPoint* points, int size,
                      Seek seek = Seek::Stationary) const {
    const Vec3 d_B = X_AB_.R_AB.transpose() * -n;
    const Features of_a = featuresNear(a_, n, &SupportPoint::a, points, size);
    Features of_b = featuresNear(b_, d_B, &SupportPoint::b_B, points, size);
    FeatureContact best;
    std::array<Vec3, 3> corners_B;
    best.n = n;
    double most = 0.0;
    for (int j = 0; j < of_b.size; ++j) {
      Feature& b = of_b.of[j];
      const std::array<Vec3, 3> own_corners = b.centre;
      for (int k = 0; k < b.size; ++k) b.centre[k] = X_AB_.p_AB + X_AB_.R_AB * b.centre[k];
      b.axis = X_AB_.R_AB * b.axis;
      b.pin_axis = X_AB_.R_AB * b.pin_axis;
      for (int i = 0; i < of_a.size; ++i) {
        const FeatureContact found = featureContactOf(of_a.of[i], b, n, seek);
        if (seek != Seek::Stationary) {
          if (best.size == 0) best = found, corners_B = own_corners;
          continue;
        }
        // A direction that was not found, or whose contact lies elsewhere, would win a tie by rounding.
        const double along =
            of_a.size * of_b.size == 1 ? 0.0 : separation(found.n) - (found.elsewhere ? rounding() : 0.0);
        if ((i == 0 && j == 0) || along > most) most = along, best = found, corners_B = own_corners;
      }
    }
    Finished finished;
    finished.n = best.n;
    finished.margin = best.margin;
    finished.belts = best.belts;
    if (isRound<CoreA>) finished.axis_a = Vec3::UnitZ();
    if (isRound<CoreB>) finished.axis_b = X_AB_.R_AB.col(2);
    for (int k = 0; k < best.size; ++k) {
      // A corner must be recognised, to the last bit.
      const int corner = best.corner_b[k];
      const Vec3 b_B =
          corner < 0 ? Vec3(X_AB_.R_AB.transpose() * (best.on_b[k] - X_AB_.p_AB)) : corners_B[corner];
      finished.nearest.add({best.on_a[k] - best.on_b[k], best.on_a[k], best.on_b[k], b_B, best.between});
    }
    return finished;
  }

 private:
  // A point between corners is no corner, however near to one it is.
  template <class Core>
  static Features featuresNear(const Core& core, const Vec3& d, Vec3 SupportPoint::*own,
                               const SupportPoint* points, int size) {
    std::array<Vec3, 4> corners;
    corners.fill(d);
    int count = 0;
    for (int i = 0; i < size; ++i)
      if (isRound<Core> || !points[i].between) corners[count++] = points[i].*own;
    if (count == 0) corners[count++] = core(d);
    return featuresAt(core, d, corners.data(), count);
  }

  double separation(const Vec3& n) const {
    const Vec3 n_B = X_AB_.R_AB.transpose() * n;
    return n.dot(X_AB_.p_AB) + n_B.dot(b_(-n_B)) - n.dot(a_(n));
  }

  double rounding() const {
    return kRounding * (a_(Vec3::UnitX()).norm() + b_(Vec3::UnitX()).norm() + X_AB_.p_AB.norm());
  }

  CoreA a_;
  CoreB b_;
  RelativePose X_AB_;
};

}  // namespace rbs

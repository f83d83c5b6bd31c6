// SPDX-License-Identifier: BSD-3-Clause
// The Coulomb problem of an island without units, as its solvers see it.
//
// Mass is measured in the mass of all bodies, speed in CoulombProblem::speed_unit. A body moves by
// y = (sqrt(m) v, L^T w), where m is its mass and L L^T its inertia, so that the mass matrix is the identity,
// the norm of y is that of kinetic energy, and no length is needed as a unit:
//   y = y_free + J^T r,   u = J y + drive.
#pragma once

#include "methods/coulomb.h"

#include <Eigen/Cholesky>

#include <vector>

namespace rbs::coulomb {

using Vec2 = Eigen::Vector2d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat36 = Eigen::Matrix<double, 3, 6>;
using Impulses = Eigen::Matrix<double, 3, Eigen::Dynamic>;    ///< r, a column a point, then one a couple: two
                                                              ///< tangents and the normal
using Velocities = Eigen::Matrix<double, 6, Eigen::Dynamic>;  ///< y, a column a body

/// The rows of J of a point or a couple.
struct Rows {
  Index i, j;      ///< bodies; kNone: a side that impulses do not move
  Mat36 J_i, J_j;  ///< u changes by J_i y_i + J_j y_j; zero where there is no body
  Vec3 drive;
  double response;  ///< mean eigenvalue of their own block of J J^T: speed for an impulse
};

struct Point : Rows {
  double mu;
  bool slides;  ///< along `slide`, whatever u_T
  Vec2 slide;   ///< of length 1 where it slides
};

/// Its velocity is that of turning times its length, so that it has the units of a point.
struct Couple : Rows {
  std::size_t first, size;  ///< its points
  double roll, spin;
  Vec2 rolls;    ///< of length 1: about this axis, whatever u_T; or zero
  double spins;  ///< 1 or -1: this way, whatever u_n; or zero
};

/// How far impulses are from the law; the greatest over the points. See CoulombResult.
struct Residuals {
  double signorini = 0.0, coulomb = 0.0, dissipation = 0.0;
  /// The largest of the three, where each point is forgiven what the rounding of its own velocity amounts to.
  double beyond_rounding = 0.0;
  double worst() const { return std::max(signorini, std::max(coulomb, dissipation)); }
};

class System {
 public:
  explicit System(const CoulombProblem& problem);

  const std::vector<Point>& points() const { return points_; }
  const std::vector<Couple>& couples() const { return couples_; }
  const Velocities& free() const { return free_; }  ///< y_free

  Vec3 velocity(const Rows& rows, const Velocities& y) const {
    Vec3 u = rows.drive;
    if (rows.i != kNone) u.noalias() += rows.J_i * y.col(rows.i);
    if (rows.j != kNone) u.noalias() += rows.J_j * y.col(rows.j);
    return u;
  }
  /// Adds J^T r of one point or couple.
  static void push(const Rows& rows, const Vec3& r, Velocities& y) {
    if (rows.i != kNone) y.col(rows.i).noalias() += rows.J_i.transpose() * r;
    if (rows.j != kNone) y.col(rows.j).noalias() += rows.J_j.transpose() * r;
  }
  /// u of impulses r, with the rounding of r only: summed in long double.
  Impulses relativeVelocities(const Impulses& r) const { return velocitiesSummedIn<long double>(r); }
  /// The same with the rounding of double, in a fraction of the time.
  Impulses relativeVelocitiesAbout(const Impulses& r) const { return velocitiesSummedIn<double>(r); }
  /// Of impulses r, with their relative velocities where those are known.
  Residuals residuals(const Impulses& r, const Impulses& velocity) const;
  Residuals residuals(const Impulses& r) const { return residuals(r, relativeVelocities(r)); }

  /// Whether the solvers are to end.
  bool isLate() const { return until_ && std::chrono::steady_clock::now() >= *until_; }

  Impulses guess(const CoulombProblem& problem) const;
  /// Writes impulses, and the velocities they make, with units.
  void store(const Impulses& r, CoulombProblem& problem) const;

 private:
  std::size_t columns() const { return points_.size() + couples_.size(); }
  const Rows& rows(std::size_t k) const {  // of a column of impulses
    return k < points_.size() ? static_cast<const Rows&>(points_[k]) : couples_[k - points_.size()];
  }

  template <class Scalar>
  Impulses velocitiesSummedIn(const Impulses& r) const;

  double speed_, impulse_;               // the units, m/s and N s
  std::vector<Eigen::LLT<Mat3>> roots_;  // by body: of its inertia
  std::vector<bool> turns_;              // by body
  std::vector<Point> points_;
  std::vector<Couple> couples_;
  Velocities free_;
  std::optional<std::chrono::steady_clock::time_point> until_;
};

/// Where a couple's impulse belongs for x: on its disc of rolling and its interval of spinning, under the sum
/// n of the normal impulses of its points.
Vec3 nearestCouple(const Couple& couple, const Vec3& x, double n);

/// The nearest impulse on the point's cone, |r_T| <= mu r_n; on the ray of its sliding where that is known.
Vec3 nearestOnCone(const Point& point, const Vec3& x);

}  // namespace rbs::coulomb

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
using Impulses =
    Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< r, a column a point: two tangents and the normal
using Velocities = Eigen::Matrix<double, 6, Eigen::Dynamic>;  ///< y, a column a body

struct Point {
  Index i, j;      ///< bodies; kNone: a side that impulses do not move
  Mat36 J_i, J_j;  ///< u changes by J_i y_i + J_j y_j; zero where there is no body
  double mu;
  Vec3 drive;
  bool slides;      ///< along `slide`, whatever u_T
  Vec2 slide;       ///< of length 1 where it slides
  double response;  ///< mean eigenvalue of the point's own block of J J^T: speed for an impulse
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
  const Velocities& free() const { return free_; }  ///< y_free

  Vec3 velocity(const Point& point, const Velocities& y) const {
    Vec3 u = point.drive;
    if (point.i != kNone) u.noalias() += point.J_i * y.col(point.i);
    if (point.j != kNone) u.noalias() += point.J_j * y.col(point.j);
    return u;
  }
  /// Adds J^T r of one point.
  static void push(const Point& point, const Vec3& r, Velocities& y) {
    if (point.i != kNone) y.col(point.i).noalias() += point.J_i.transpose() * r;
    if (point.j != kNone) y.col(point.j).noalias() += point.J_j.transpose() * r;
  }
  /// u of impulses r, a column a point, with the rounding of r only: summed in long double.
  Impulses relativeVelocities(const Impulses& r) const;
  /// Of impulses r, with their relative velocities where those are known.
  Residuals residuals(const Impulses& r, const Impulses& velocity) const;
  Residuals residuals(const Impulses& r) const { return residuals(r, relativeVelocities(r)); }

  /// Whether the solvers are to end.
  bool isLate() const { return until_ && std::chrono::steady_clock::now() >= *until_; }

  Impulses guess(const CoulombProblem& problem) const;
  /// Writes impulses, and the velocities they make, with units.
  void store(const Impulses& r, CoulombProblem& problem) const;

 private:
  double speed_, impulse_;               // the units, m/s and N s
  std::vector<Eigen::LLT<Mat3>> roots_;  // by body: of its inertia
  std::vector<Point> points_;
  Velocities free_;
  std::optional<std::chrono::steady_clock::time_point> until_;
};

/// The nearest impulse on the point's cone, |r_T| <= mu r_n; on the ray of its sliding where that is known.
Vec3 nearestOnCone(const Point& point, const Vec3& x);

}  // namespace rbs::coulomb

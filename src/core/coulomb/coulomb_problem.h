// SPDX-License-Identifier: BSD-3-Clause
// The exact velocity-level Coulomb problem of one island of bodies.
//
// Impulses r at the contact points change the velocities of the bodies, v = v_free + M^-1 J^T r, so that at
// each point the relative velocity u = J v + bias and the impulse keep
//   0 <= r_n,  0 <= u_n,  r_n u_n = 0                              (Signorini)
//   |r_T| <= mu r_n                                                (Coulomb's cone, circular)
//   u_T = -a r_T,  a >= 0,  a (mu r_n - |r_T|) = 0                 (friction dissipates all it can).
// A point may give way, u_n = (J v + bias)_n + give r_n: what is squeezed between sides that no impulse moves has
// no other solution.
// Nothing else is relaxed: no pyramid, no dilation (u_n = mu |u_T| at sliding points), no softness.
//
// A pair may also resist rolling and spinning. With the sum N of the normal impulses of its points, the
// angular impulse L that it puts on j, its length R, and the angular velocity w of j against i,
//   |L_T| <= c R N,  against w_T;   |L_n| <= s R N,  against w_n
// in the same sense: each does what ends the turning, or dissipates all it can.
//
// Rows of joints, of their limits and of what drives them have impulses within bounds (BoundedRows).
#pragma once

#include "base/algebra.h"
#include "base/index.h"
#include "base/solve_budget.h"
#include "rigid_body_sim/types.h"

#include <vector>

namespace rbs {

/// A body that impulses move.
struct CoulombBody {
  double mass;     ///< kg, > 0
  Mat3 inertia_W;  ///< about its centre of mass, written in W, kg m^2, positive definite
  /// Of the centre, m/s, and angular, rad/s, both in W. In: the velocity it would have without contact
  /// impulses (after the forces of the step). Out: with them.
  Vec3 v, w;
  bool turns = true;  ///< false: no impulse changes w, and the inertia is not read
};

/// A contact point of two sides. At least one of them is a body.
struct CoulombPoint {
  Index i, j;     ///< in CoulombProblem::bodies; kNone: a side that impulses do not move
  Vec3 r_i, r_j;  ///< from the centres to the point, m, in W; not read for a side that is kNone
  Mat3 frame;     ///< orthonormal columns t1, t2, n in W; n points from i to j
  double mu;      ///< >= 0
  /// In the frame, added to the velocity of j against i, m/s: the velocity of a kinematic side, the speed
  /// at which an open gap may close (+gap/h along n), restitution.
  Vec3 bias{0.0, 0.0, 0.0};
  /// Of revolution, of the only body of the point, of length 1: no normal impulse has a moment about it, though the point may
  /// be one of a few that stand for a rim. Zero: there is none, or two bodies, of which the angular momentum is to stay.
  Vec3 axis_W{0.0, 0.0, 0.0};
  /// Speed by which u_n grows for an impulse along n, m/s by N s: how a side gives way that impulses do not move. 0: it does not.
  double give = 0.0;
  /// Of length 1: the point is known to slide this way in (t1, t2), and friction is -mu r_n slide whatever
  /// u_T is. Zero: Coulomb's law decides.
  Eigen::Vector2d slide{0.0, 0.0};
  /// In the frame, on j (and the opposite on i), N s. In: a warm start, zero for none; one that is not finite
  /// counts as none. Out: the solution.
  Vec3 impulse{0.0, 0.0, 0.0};
};

/// What a pair resists turning with.
struct TorqueConstraint {
  Index i, j;         ///< as in CoulombPoint
  Index first, size;  ///< its points, in CoulombProblem::points
  Mat3 frame;         ///< from it to W: n is the axis of spinning, t1 and t2 those of rolling
  double radius;      ///< R, m, > 0
  double roll, spin;  ///< c and s, >= 0
  /// In the frame, R times the angular velocity that sides add which impulses do not move, m/s.
  Vec3 bias{0.0, 0.0, 0.0};
  /// The pair is known to roll about this axis in (t1, t2), of length 1, and to spin this way, 1 or -1. Zero:
  /// the law decides.
  Eigen::Vector2d rolls{0.0, 0.0};
  double spins = 0.0;
  /// In the frame, L/R on j, N s. In: a warm start. Out: the solution.
  Vec3 impulse{0.0, 0.0, 0.0};
};

/// Up to three rows of a joint, of its limits or of what drives it. Each has an impulse within bounds of its own, and
///   u = 0 where lo < r < hi,   u >= 0 where r = lo,   u <= 0 where r = hi.
/// Without bounds a row is bilateral; 0 and infinity make it unilateral; equal bounds prescribe its impulse, 0 in a row
/// that is not used.
struct BoundedRows {
  using Jacobian = Eigen::Matrix<double, 3, 6>;

  Index i, j;  ///< as in CoulombPoint
  /// u = bias + J_i (v_i, w_i) + J_j (v_j, w_j), m/s: a row of turning is multiplied by a length. Not read for a side that is
  /// kNone.
  Jacobian J_i, J_j;
  Vec3 bias{0.0, 0.0, 0.0};
  Vec3 lo, hi;  ///< N s, lo <= hi; infinite: no bound
  /// N s. In: a warm start. Out: the solution. It changes the momentum of a side by J^T impulse.
  Vec3 impulse{0.0, 0.0, 0.0};
};

/// The moments about a centre of unit impulses along the columns of a frame, at r from that centre, m; `axis_W` as in
/// CoulombPoint.
inline Mat3 momentsOf(const Vec3& r, const Mat3& frame, const Vec3& axis_W) {
  Mat3 moments;
  moments << r.cross(frame.col(0)), r.cross(frame.col(1)), r.cross(frame.col(2));
  moments.col(2) -= momentAbout(axis_W, r, frame.col(2)) * axis_W;
  return moments;
}

struct CoulombProblem {
  std::vector<CoulombBody> bodies;
  std::vector<CoulombPoint> points;
  /// What velocities are measured against, m/s, > 0: g h, or what stands in for it where g = 0. The unit of
  /// impulse is the mass of all bodies times this.
  double speed_unit;
  SolveBudget* budget = nullptr;  ///< null: the solvers end when they are done
  std::vector<TorqueConstraint> torques{};
  std::vector<BoundedRows> joints{};
};

}  // namespace rbs

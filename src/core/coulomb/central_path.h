// SPDX-License-Identifier: BSD-3-Clause
// The central path of the Coulomb problem, on which interior point methods move, and Newton's method for its
// points.
//
// Coulomb's law of a point in two complementary pairs, the impulse and the speed along the normal and, where
// there is friction, the two vectors of its barrier (friction_barrier.h):
//   r_n >= 0,  u_n >= 0,  r_n u_n = 0;   b = (r_T, mu r_n),  h = (u_T, a),  b o h = 0.
// De Saxce's shift is eliminated with the free speed a: what ties the pairs is that mu r_n is both the
// limit of friction and the first impulse, and that stays within Newton's matrix below. A torque constraint has the
// second pair alone, once for rolling and once for spinning, with the sum N of the normal impulses of its
// points for r_n. Where a factor of friction is 0, or the direction of slip is prescribed, there is no pair. The rows of a
// joint have a pair for each of their bounds (box_barrier.h).
//
// A point of the path has all products equal to t e, and a share of the errors
//   off = u - J y - bias,   away = y - y_free - J^T r
// that the start has. The start is on it, at share 1; the solution at t = 0 and share 0. Since the problem is
// not monotone, the path may turn back at some t on its way.
//
// Newton's step (du, dr, dy, and so on), with a wanted change c of r_n u_n, is
//   dr_n = (c - r_n du_n)/u_n
// and that of the barriers, so that dr = e - D du at each point, D having the column of dr_n/du_n also in its
// tangential rows: it is not symmetric. At a torque it is e - D du + g dN. Wanted changes of off and away
// make du = J dy + d(off) and
//   (1 + J^T D J) dy = d(away) + J^T (e - D d(off)),
// in which dN stands for what it is at its points. D grows without bound where a product goes to 0, and the
// factors lose their digits with it.
#pragma once

#include "coulomb/body_blocks.h"
#include "coulomb/box_barrier.h"
#include "coulomb/coulomb_system.h"
#include "coulomb/friction_barrier.h"

#include <vector>

namespace rbs::coulomb {

class CentralPath {
 public:
  struct PointPairs {
    double r_n, u_n;
    ConePair<2> sliding;
  };
  struct TorquePairs {
    ConePair<2> rolling;
    ConePair<1> spinning;
  };
  /// Where a method is, or a direction to go.
  struct Place {
    Velocities y;
    std::vector<PointPairs> points;
    std::vector<TorquePairs> torques;
    std::vector<BoxPairs> joints;
    Place& add(double part, const Place& direction);
    /// The sum of the normal impulses of a torque's points.
    double normalSum(const TorqueRows& torque) const;
  };

  CentralPath(const System& system, BodyBlocks& matrix);

  Place place;
  /// Starts near a guess: at 1 - `part` times the place of its impulses and the velocities they make, plus `part` times the
  /// start without a guess. `part` is above 0, and 1 at most.
  void startNear(const Impulses& guess, double part);
  Impulses impulses() const;
  /// 0 where there are no pairs: then all steps are Newton's own.
  double meanProduct() const;

  /// To be called where `place` is new, before what follows. False where the matrix is singular.
  bool linearise();
  /// How far the products are from t, as a fraction of it, and the errors from their share: the largest.
  double distance(double t, double share) const;
  /// The step to products of t and this share of errors. With the second order of an earlier step where one
  /// is given. False where the equations could not be solved.
  bool step(double t, double share, const Place* earlier, Place& direction) const;
  /// What changes with log t, the share of errors being proportional to t.
  bool tangent(double t, double share, Place& direction) const;
  /// How many times a direction can be added until a pair leaves its cone.
  double room(const Place& direction) const;
  /// A direction with each pair as a fraction of where it is.
  Eigen::VectorXd relative(const Place& direction) const;

 private:
  struct TorqueBarriers {
    FrictionBarrier<2> rolling;
    FrictionBarrier<1> spinning;
  };
  /// The wanted changes of the pairs of a point, c and q, and of a torque.
  struct PointWanted {
    double product;
    Vec3 sliding;
  };
  struct TorqueWanted {
    Vec3 rolling;
    Vec2 spinning;
  };
  /// What a step is to change.
  struct Wanted {
    std::vector<PointWanted> points;
    std::vector<TorqueWanted> torques;
    std::vector<BoxBarrier::Wanted> joints;
    Impulses off;
    Velocities away;
  };

  bool solve(const Wanted& wanted, Place& direction) const;
  /// Adds J^T of what impulses change by where velocities change by du(k): -D du, and at torques + g dN.
  template <class Change>
  void addResponse(const Change& du, Velocities& y) const;
  Velocities residual(const Velocities& right, const Velocities& dy) const;

  const System& system_;
  BodyBlocks& matrix_;
  int count_ = 0;                            // of pairs
  std::vector<FrictionBarrier<2>> sliding_;  // by point
  std::vector<TorqueBarriers> torques_;
  std::vector<BoxBarrier> joints_;
  std::vector<Mat3> D_;  // by column of impulses
  std::vector<Vec3> g_;  // by torque
  Impulses off_, first_off_;
  Velocities away_, first_away_;
};

}  // namespace rbs::coulomb

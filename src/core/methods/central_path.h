// SPDX-License-Identifier: BSD-3-Clause
// The central path of the Coulomb problem, on which interior point methods move, and Newton's method for its
// points.
//
// Coulomb's law of a point in two complementary pairs of vectors in cones, with x o z their Jordan product in
// the cone (Alizadeh and Goldfarb 2003; the pairs as in Howell et al., "Dojo", 2022):
//   r_n >= 0,  u_n >= 0,                                 r_n u_n = 0
//   b = (r_T, mu r_n),  h = (u_T, a),  |.| <= last,      b o h = 0.
// The free speed a has no place in the dynamics; the second product makes |u_T| <= a and has friction oppose
// sliding at its limit. De Saxce's shift is eliminated with it: what couples the pairs is that mu r_n is both
// the limit of friction and the first impulse, and that stays within Newton's matrix below. Where mu = 0, or
// where the point slides in a given direction, there is the first pair only.
//
// A point of the path has all products equal to t e, and a share of the errors
//   off = u - J y - drive,   away = y - y_free - J^T r
// that the start has. The start is on it, at share 1; the solution at t = 0 and share 0. Since the problem is
// not monotone, the path may turn back at some t on its way.
//
// Newton's step (du, dr, dy, and so on). With the scaling W of Nesterov and Todd (1997; the formulas are
// those of Andersen, Dahl and Vandenberghe 2003), W h = W^-1 b = l, and wanted changes c of r_n u_n and k of
// l o l,
//   dr_n = (c - r_n du_n)/u_n,   db = q - W^2 dh,   q = W (l \ k).
// With W^2 in blocks A (tangential), v (tangential and last), g (last), and db_n = mu dr_n, which gives da,
//   dr_T = q_T - v/g (q_n - mu dr_n) - (A - v v^T/g) du_T,
// so that dr = e - D du at each point, D having the column of dr_n/du_n also in its tangential rows: it is
// not symmetric. Wanted changes of off and away make du = J dy + d(off) and
//   (1 + J^T D J) dy = d(away) + J^T (e - D d(off)).
// D grows without bound where a product goes to 0, and the factors lose their digits with it.
#pragma once

#include "methods/body_blocks.h"
#include "methods/coulomb_system.h"

#include <vector>

namespace rbs::coulomb {

class CentralPath {
 public:
  /// The two pairs of a point.
  struct Pairs {
    double r_n, u_n;
    Vec3 b, h;  ///< tangential, and the axis of the cone last; zero where there is only the first pair
  };
  /// Where a method is, or a direction to go.
  struct Place {
    Velocities y;
    std::vector<Pairs> pairs;
    Place& add(double part, const Place& direction);
  };

  CentralPath(const System& system, BodyBlocks& matrix);

  Place place;
  Impulses impulses() const;
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
  struct Scaling {
    Mat3 W, inverse, square;
    Vec3 l;
    void set(const Vec3& b, const Vec3& h);
  };
  struct Wanted {
    double product;  // c
    Vec3 products;   // k
    Vec3 off;
  };

  bool isRound(std::size_t k) const { return system_.points()[k].mu > 0.0 && !system_.points()[k].slides; }
  Vec3 impulse(std::size_t k) const;
  bool solve(const std::vector<Wanted>& wanted, Velocities right, Place& direction) const;
  Velocities residual(const Velocities& right, const Velocities& dy) const;

  const System& system_;
  BodyBlocks& matrix_;
  int count_ = 0;  // of pairs
  std::vector<Scaling> scaling_;
  std::vector<Mat3> D_;
  std::vector<Vec3> off_, first_off_;
  Velocities away_, first_away_;
};

}  // namespace rbs::coulomb

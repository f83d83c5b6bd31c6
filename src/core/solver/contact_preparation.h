// SPDX-License-Identifier: BSD-3-Clause
// Contact preparation: what the soft step, the exact step, the impacts and the search for missed contacts
// have to know of two bodies before a contact law can be applied to them.
#pragma once

#include "narrowphase/manifold.h"
#include "state/context.h"

namespace rbs {

/// What all points of a contact share.
struct PairConstants {
  double length;  ///< the smaller one of the two bodies, m: the unit of the tolerances of a contact
  double mu;      ///< Coulomb coefficient; 0 when friction is off
  double e;       ///< Newton's coefficient of restitution; 0 when restitution is off
  /// Speed at which an overlap may be separated, m/s: that of a body after a fall over its own length, or
  /// where other loads than gravity press the pair together, after such a way under these.
  double push;
};
PairConstants pairConstants(const Context& context, Index i, Index j);

/// The smaller length of two bodies, m.
double smallerLength(const Bodies& bodies, Index i, Index j);

/// How far from the centre of a body the surface lies that another may touch within `time` (s), m, as far as
/// turning moves it: 0 for a sphere. A plane has no end: the other body touches it as far away as it gets.
/// p_W and u_W are the position and the velocity of one centre from the other.
double reachOf(const Traits& body, const Traits& other, const Vec3& p_W, const Vec3& u_W, double time);

/// How far two surfaces can approach each other within `time` (s), m: by the relative velocity u_W and the
/// relative acceleration a_W of their centres, and by the speeds at which turning moves their surfaces.
inline double approach(double time, const Vec3& u_W, double turning_i, double turning_j, const Vec3& a_W) {
  return time * (u_W.norm() + turning_i + turning_j + 0.5 * time * a_W.norm());
}

/// The points of two bodies at these poses whose separation is at most `margin` (m, >= 0).
Manifold contactManifold(const Bodies& bodies, Index i, const Pose& X_WI, Index j, const Pose& X_WJ,
                         double margin);

}  // namespace rbs

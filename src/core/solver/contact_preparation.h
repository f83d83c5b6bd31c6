// SPDX-License-Identifier: BSD-3-Clause
// Contact preparation: what the soft step, the exact step, the impacts and the search for missed contacts
// have to know of two bodies before a contact law can be applied to them.
#pragma once

#include "base/algebra.h"
#include "base/tolerances.h"
#include "narrowphase/lasting_axis.h"
#include "narrowphase/manifold.h"
#include "narrowphase/time_of_impact.h"
#include "state/context.h"

namespace rbs {

/// What all points of a contact share.
struct PairConstants {
  double length;  ///< the smaller one of the two bodies, m: the unit of the tolerances of a contact
  double mu;      ///< Coulomb coefficient; 0 when friction is off
  double e;       ///< Newton's coefficient of restitution; 0 when restitution is off
  double load;    ///< acceleration that presses the pair together, m/s²: gravity, or what acts beside it
  bool carried;   ///< a contact carried one of the bodies in the last step
  double bears;   ///< force of a loaded contact, N: solvers leave smaller ones where nothing touches
  /// Speed at which an overlap may be separated, m/s: that of a body after a fall over its own length, or
  /// where other loads than gravity press the pair together, after such a way under these.
  double push;
};
PairConstants pairConstants(const Context& context, Index i, Index j);

/// The smaller length of two bodies, m.
double smallerLength(const Bodies& bodies, Index i, Index j);

/// Share of gravity, or of a load, that counts as driving a pair together along which it does not act: contacts may pass it on.
inline constexpr double kAcross = 0.04;

/// The speed of a rebound along n, m/s, that the soft step would not show: gravity, or what contacts pass on of it, ends it
/// within the step.
double slowestRebound(const Context& context, const Vec3& n_W);

/// How far from the centre of a body the surface lies that another may touch within `time` (s), m, as far as
/// turning moves it: 0 for a sphere. A plane has no end: the other body touches it as far away as it gets.
/// p_W and u_W are the position and the velocity of one centre from the other.
double reachOf(const Traits& body, const Traits& other, const Vec3& p_W, const Vec3& u_W, double time);

/// How far two surfaces can approach each other within `time` (s), m: by the relative velocity u_W and the
/// relative acceleration a_W of their centres, and by the speeds at which turning moves their surfaces.
inline double approach(double time, const Vec3& u_W, double turning_i, double turning_j, const Vec3& a_W) {
  return time * (u_W.norm() + turning_i + turning_j + 0.5 * time * a_W.norm());
}

/// w h of a soft contact in sub-steps of length h. Stiffer sags less, but a stack of ten then never comes to
/// rest (from 0.45 pi) or gains energy as it lands (from 0.35 pi).
inline constexpr double kStiffness = 0.3 * kPi;

/// How far two faces may differ in height where a body slides from one to the other, and what counts as rest,
/// in the exact step: it leaves no overlap above the one, and no velocity above the other.
LastingLimits exactLimits(const StepStore& step, const PairConstants& pair);
/// How far a body sinks into a soft contact in sub-steps of length h (s), m: by load/w^2.
double sag(const PairConstants& pair, double h);
/// The same limits in the soft step: a body that contacts carry sinks in, and more may lie on it.
LastingLimits softLimits(const StepStore& step, const PairConstants& pair, double h);

/// Within which the points of a contact are looked for, m: `margin`, or any distance where it was missed before.
double searchMargin(const Contact& contact, double margin);

/// The points of two bodies on their trajectories for the time until `until` (s), as lastingManifold() finds them; but on
/// the side of their last normal where they overlap deeply and the nearest way out leads to another.
Manifold contactManifold(const Bodies& bodies, Index i, const Motion& trajectory_i, Index j,
                         const Motion& trajectory_j, double from, double until, double margin,
                         const LastingLimits& limits, const LastNormal& last, SeparatingAxis& axis);

/// Whether it is known that none of these contacts between two bodies that forces move bears a force: the bodies lie beside each
/// other at most.
bool areApart(const Context& context, const std::vector<Index>& contacts);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The manifold of two moving shapes, with the normal that matters for their motion.
#pragma once

#include "narrowphase/manifold.h"
#include "narrowphase/separating_axis.h"
#include "narrowphase/time_of_impact.h"

namespace rbs {

/// What counts as closing and as separated for lastingManifold().
struct LastingLimits {
  double tolerance;  ///< m, >= 0: a face separates while the overlap along its normal is no more than this
  double slowest;    ///< m/s, >= 0: a pair that closes more slowly is at rest
  /// Share of the closing along the narrow phase's normal that one along a face may have, 0 to 1. What is
  /// nearly the same would be decided by noise, anew in each step.
  double closing;
};

/// The contact manifold of A and B at `from` for the time until `until` (s): the points whose separation is
/// at most `margin` (m, >= 0). Neither may be a plane. Of two shapes without faces it is that of collide().
///
/// Its normal is that of collide(), unless the two close along it while the normal of a face near their
/// contact separates them for the whole time, or until they have turned by 0.01 rad. Then the points are
/// those of the end of that time, seen from `from`: their separation is the one from which the motion leads
/// there. Empty where the two pass each other. A normal along which the pair already bears a force stays, of two
/// polytopes also where another one separates them by up to the tolerance more, as where their edges meet:
/// `loaded_W` is that direction, and zero where there is none. `axis` is the separating axis of the pair's
/// last query (collide.h).
///
/// Costs a collide(), and two support queries where the pair closes. What it costs beyond that is for pairs
/// at an edge.
Manifold lastingManifold(const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b,
                         double from, double until, double margin, const LastingLimits& limits,
                         const Vec3& loaded_W, SeparatingAxis& axis);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Impacts: closing pairs whose contact is located in time and resolved at that time, in order.
//
// A pair in contact that has no restitution is the contact solver's, and so is one that closes too slowly for
// a rebound to be seen. All others are looked at.
#pragma once

#include "dynamics/motion.h"
#include "state/context.h"

namespace rbs::impacts {

/// Finds the pairs that will impact during the step, and takes them out of the contact solve with those that
/// will not even touch.
void predict(Context& context);

/// What is predicted of a pair from some time to the end of the step.
struct Prediction {
  std::optional<PendingImpact> impact;  ///< the first, unless it is left to the contact solver
  bool touches = false;                 ///< they touch, impact or not
  std::optional<Vec3> rest_W;  ///< the normal, i to j, where they touch from the start and do not collide
  int queries = 0;             ///< closest points and manifolds it took; none where a form is closed
};
/// `axis` is that of the contact of the pair, i before j; of a pair without one: none.
Prediction predict(const Context& context, Index i, Index j, double from, SeparatingAxis& axis);

/// A body's trajectory from where it has been advanced to. A supported body is predicted to keep its velocities:
/// what carries it cancels its load.
Motion trajectoryOf(const Context& context, Index i);

/// Whether a body's trajectory is known: nothing carries it now, and no torque turns it by more than matters.
bool isFree(const Context& context, Index i);

/// Whether the impacts of a pair take energy away, by their restitution or by friction.
bool losesEnergy(const SceneStore& scene, Index i, Index j);

/// How fast turning moves the surface of a body, m/s.
double turningSpeed(const Bodies& bodies, Index i);

/// Whether contacts stop a pair as well as an impact does: it does not rebound, and no sub-step, or at the exact settings the
/// step, takes one far into the other. An open point may close no faster than its gap in that time. Speeds are those that a group
/// sees that moves with `group_W`, m/s: it stops them, also those of a body that has just joined it.
bool isStoppedByContacts(const Context& context, const PendingImpact& impact, const Vec3& group_W);

enum class Outcome {
  Rebound,  ///< the bodies part
  Stay,     ///< they stay together: from here on a contact
  Miss,     ///< they are not where they were expected
};
/// Resolves the impact of the two bodies of a contact at `time`. Its impulses are those of earlier in the
/// step.
Outcome resolve(Context& context, Contact& contact, double time);

}  // namespace rbs::impacts

// SPDX-License-Identifier: BSD-3-Clause
#include "solver/contact_preparation.h"

#include "narrowphase/collide.h"

#include <algorithm>

namespace rbs {

double smallerLength(const Bodies& bodies, Index i, Index j) {
  return std::min(bodies.traits[i].length, bodies.traits[j].length);
}

PairConstants pairConstants(const Context& context, Index i, Index j) {
  const SceneStore& scene = context.scene;
  PairConstants pair;
  pair.length = smallerLength(scene.bodies, i, j);
  pair.mu = scene.frictionOf(i, j);
  pair.e = scene.restitutionOf(i, j);
  const double load = (context.step.load[j].a_W - context.step.load[i].a_W).norm();
  pair.push = fallSpeed(std::max(scene.gravity_W.norm(), load), pair.length);
  return pair;
}

double reachOf(const Traits& body, const Traits& other, const Vec3& p_W, const Vec3& u_W, double time) {
  if (body.round) return 0.0;
  if (body.unbounded) return p_W.norm() + time * u_W.norm() + other.bounding_radius;
  return body.bounding_radius;
}

Manifold contactManifold(const Bodies& bodies, Index i, const Pose& X_WI, Index j, const Pose& X_WJ,
                         double margin) {
  return collide(bodies.traits[i].shape, X_WI, bodies.traits[j].shape, X_WJ, margin);
}

}  // namespace rbs

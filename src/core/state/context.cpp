// SPDX-License-Identifier: BSD-3-Clause
#include "state/context.h"

#include <algorithm>
#include <cmath>

namespace rbs {

double SceneStore::frictionOf(Index i, Index j) const {
  if (!effects[Effect::Friction]) return 0.0;
  return std::sqrt(bodies.traits[i].material.friction * bodies.traits[j].material.friction);
}

double SceneStore::restitutionOf(Index i, Index j) const {
  if (!effects[Effect::Restitution]) return 0.0;
  return std::max(bodies.traits[i].material.restitution, bodies.traits[j].material.restitution);
}

bool SceneStore::isAsleep(const Contact& contact) const {
  const Traits& a = bodies.traits[bodies.indexOf(contact.key.i)];
  const Traits& b = bodies.traits[bodies.indexOf(contact.key.j)];
  return (a.asleep || b.asleep) && !a.moved_by_forces() && !b.moved_by_forces();
}

double fallSpeed(double gravity, double length) {
  constexpr double kEarth = 9.81;
  return std::sqrt((gravity > 0.0 ? gravity : kEarth) * length);
}

}  // namespace rbs

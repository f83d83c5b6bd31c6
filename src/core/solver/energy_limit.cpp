// SPDX-License-Identifier: BSD-3-Clause
#include "solver/energy_limit.h"

#include "base/tolerances.h"

#include <algorithm>
#include <cmath>

namespace rbs {

void EnergyLimit::find(const Context& context, const SolverContacts& contacts, bool all, double gain) {
  gain_ = gain;
  const StepStore& step = context.step;
  std::vector<Index> found;  // islands
  for (const SolverBlock& block : contacts.blocks) {
    const auto points = contacts.points.begin() + block.first;
    const double deep = kDeep * smallerLength(context.scene.bodies, contacts.bodies[block.i].body,
                                              contacts.bodies[block.j].body);
    if (all || std::any_of(points, points + block.size, [&](const SolverPoint& p) { return p.gap < -deep; }))
      found.push_back(contacts.islandOf(block));
  }
  for (const SolverBody& s : contacts.bodies)
    if (s.inv_mass > 0.0 && step.isCrowded(s.body)) found.push_back(step.island[s.body]);
  islands_.begin(context, contacts, std::move(found));
}

// Takes the energy from the motions about the common centre first, which keeps the momentum.
void EnergyLimit::apply(const Context& context, SolverContacts& contacts) const {
  for (Index k = 0; k < islands_.size(); ++k) {
    double mass = 0.0, energy = 0.0, given = islands_[k].energy;
    Vec3 momentum = Vec3::Zero();
    for (const SolverBody& s : contacts.bodies) {
      if (islands_.placeOf(context, s) != k) continue;
      given += loadWork(context, s);
      mass += 1.0 / s.inv_mass, momentum += s.v / s.inv_mass, energy += kineticEnergy(context, s);
    }
    const double kinematic_speed = islands_[k].kinematic_speed;
    const double most = std::max(0.0, given + 0.5 * mass * kinematic_speed * kinematic_speed);
    if (energy <= (1.0 + gain_) * most) continue;
    const Vec3 common = momentum / mass;
    const double together = 0.5 * mass * common.squaredNorm(), apart = energy - together;
    const double share = apart > 0.0 ? std::sqrt(std::clamp((most - together) / apart, 0.0, 1.0)) : 0.0;
    const double rest = together > most ? std::sqrt(most / together) : 1.0;
    for (SolverBody& s : contacts.bodies)
      if (islands_.placeOf(context, s) == k) s.v = rest * common + share * (s.v - common), s.w *= share;
  }
}

}  // namespace rbs

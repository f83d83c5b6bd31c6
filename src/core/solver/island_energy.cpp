// SPDX-License-Identifier: BSD-3-Clause
#include "solver/island_energy.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rbs {

double spinEnergy(const Context& context, const SolverBody& s, const Vec3& w_W) {
  const Bodies& bodies = context.scene.bodies;
  return bodies.spinEnergy(s.body, bodies.pose[s.body].q_WB, w_W);
}

double kineticEnergy(const Context& context, const SolverBody& s) {
  return 0.5 * s.v.squaredNorm() / s.inv_mass + spinEnergy(context, s, s.w);
}

double loadWork(const Context& context, const SolverBody& s) {
  const Load& load = context.step.load[s.body];
  return load.a_W.dot(s.moved) / s.inv_mass + load.torque_W.dot(s.turned);
}

void SomeIslands::set(std::vector<Index> islands) {
  islands_ = std::move(islands);
  std::sort(islands_.begin(), islands_.end());
  islands_.erase(std::unique(islands_.begin(), islands_.end()), islands_.end());
}

Index SomeIslands::placeOf(Index island) const {
  const auto known = std::lower_bound(islands_.begin(), islands_.end(), island);
  return known == islands_.end() || *known != island ? kNone : static_cast<Index>(known - islands_.begin());
}

void IslandEnergies::begin(const Context& context, const SolverContacts& contacts,
                           std::vector<Index> islands) {
  islands_.set(std::move(islands));
  if (islands_.empty()) return;
  energies_.resize(islands_.size());
  for (const SolverBody& s : contacts.bodies)
    if (const Index k = placeOf(context, s); k != kNone) energies_[k].energy += kineticEnergy(context, s);
  for (const SolverBlock& block : contacts.blocks) {
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    for (const auto& [kinematic, pushed, reach] :
         {std::tuple(&i, &j, block.reach_i), std::tuple(&j, &i, block.reach_j)}) {
      if (kinematic->inv_mass > 0.0 || kinematic->still) continue;
      const Index k = placeOf(context, *pushed);
      if (k == kNone) continue;
      const double speed = kinematic->v.norm() + reach * kinematic->w.norm();
      energies_[k].kinematic_speed = std::max(energies_[k].kinematic_speed, speed);
    }
  }
}

}  // namespace rbs

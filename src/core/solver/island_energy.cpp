// SPDX-License-Identifier: BSD-3-Clause
#include "solver/island_energy.h"

#include <algorithm>
#include <tuple>

namespace rbs {

double kineticEnergy(const Context& context, const SolverBody& s) {
  const Vec3 w_B = context.scene.bodies.pose[s.body].q_WB.conjugate() * s.w;
  return 0.5 * (s.v.squaredNorm() / s.inv_mass +
                w_B.dot(context.scene.bodies.inertia[s.body].moments.cwiseProduct(w_B)));
}

double loadWork(const Context& context, const SolverBody& s) {
  const Load& load = context.step.load[s.body];
  return load.a_W.dot(s.moved) / s.inv_mass + load.torque_W.dot(s.turned);
}

void IslandEnergies::begin(const Context& context, const SolverContacts& contacts,
                           std::vector<Index> islands) {
  std::sort(islands.begin(), islands.end());
  islands.erase(std::unique(islands.begin(), islands.end()), islands.end());
  for (const Index island : islands) islands_.push_back({island});
  if (islands_.empty()) return;
  for (const SolverBody& s : contacts.bodies)
    if (const Index k = placeOf(context, s); k != kNone) islands_[k].energy += kineticEnergy(context, s);
  for (const SolverBlock& block : contacts.blocks) {
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    for (const auto& [kinematic, pushed, reach] :
         {std::tuple(&i, &j, block.reach_i), std::tuple(&j, &i, block.reach_j)}) {
      if (kinematic->inv_mass > 0.0 || kinematic->still) continue;
      const Index k = placeOf(context, *pushed);
      if (k == kNone) continue;
      const double speed = kinematic->v.norm() + reach * kinematic->w.norm();
      islands_[k].kinematic_speed = std::max(islands_[k].kinematic_speed, speed);
    }
  }
}

Index IslandEnergies::placeOf(const Context& context, const SolverBody& s) const {
  if (s.inv_mass == 0.0) return kNone;
  const Index island = context.step.island[s.body];
  const auto known = std::lower_bound(islands_.begin(), islands_.end(), island,
                                      [](const IslandEnergy& one, Index k) { return one.island < k; });
  if (known == islands_.end() || known->island != island) return kNone;
  return static_cast<Index>(known - islands_.begin());
}

}  // namespace rbs

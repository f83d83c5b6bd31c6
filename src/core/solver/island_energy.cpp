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

double kineticEnergy(const Context& context, const SolverBody& s, const Vec3& U_W) {
  return 0.5 * (s.v - U_W).squaredNorm() / s.inv_mass + spinEnergy(context, s, s.w);
}

double loadWork(const Context& context, const SolverBody& s, const Vec3& U_W, double seconds) {
  const Load& load = context.step.load[s.body];
  return load.a_W.dot(s.moved - seconds * U_W) / s.inv_mass + load.torque_W.dot(s.turned);
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
  std::vector<char> is_pushed(islands_.size()), is_common(islands_.size(), 1);
  for (const SolverBlock& block : contacts.blocks) {
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    for (const auto& [base, pushed, reach] :
         {std::tuple(&i, &j, block.reach_i), std::tuple(&j, &i, block.reach_j)}) {
      if (base->inv_mass > 0.0) continue;
      const Index k = placeOf(context, *pushed);
      if (k == kNone) continue;
      IslandEnergy& of = energies_[k];
      if (!std::exchange(is_pushed[k], 1)) of.U_W = base->v;
      is_common[k] = is_common[k] && of.U_W == base->v && base->w.isZero(0.0);
      if (!base->still)
        of.kinematic_speed = std::max(of.kinematic_speed, base->v.norm() + reach * base->w.norm());
    }
  }
  for (std::size_t k = 0; k < energies_.size(); ++k)
    if (is_common[k])
      energies_[k].kinematic_speed = 0.0;
    else
      energies_[k].U_W.setZero();
  for (const SolverBody& s : contacts.bodies)
    if (const Index k = placeOf(context, s); k != kNone)
      energies_[k].energy += kineticEnergy(context, s, energies_[k].U_W);
}

}  // namespace rbs

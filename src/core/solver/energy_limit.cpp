// SPDX-License-Identifier: BSD-3-Clause
#include "solver/energy_limit.h"

#include "base/tolerances.h"

#include <algorithm>
#include <cmath>
#include <set>

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

void EnergyLimit::find(const Context& context, const SolverContacts& contacts) {
  const StepStore& step = context.step;
  std::set<Index> found;  // islands
  for (const SolverBlock& block : contacts.blocks) {
    const auto points = contacts.points.begin() + block.first;
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    const double deep = kDeep * smallerLength(context.scene.bodies, i.body, j.body);
    if (std::any_of(points, points + block.size, [&](const SolverPoint& p) { return p.gap < -deep; }))
      found.insert(step.island[i.inv_mass > 0.0 ? i.body : j.body]);
  }
  for (const SolverBody& s : contacts.bodies)
    if (s.inv_mass > 0.0 && step.isCrowded(s.body)) found.insert(step.island[s.body]);
  for (const Index island : found) islands_.push_back({island, 0.0});
  if (islands_.empty()) return;
  for (const SolverBody& s : contacts.bodies)
    if (DeepIsland* island = deepIslandOf(context, s)) island->energy += kineticEnergy(context, s);
  for (const SolverBlock& block : contacts.blocks) {
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    for (const auto& [kinematic, pushed, reach] :
         {std::tuple(&i, &j, block.reach_i), std::tuple(&j, &i, block.reach_j)}) {
      if (kinematic->inv_mass > 0.0 || kinematic->still) continue;
      if (DeepIsland* island = deepIslandOf(context, *pushed))
        island->kinematic_speed =
            std::max(island->kinematic_speed, kinematic->v.norm() + reach * kinematic->w.norm());
    }
  }
}

EnergyLimit::DeepIsland* EnergyLimit::deepIslandOf(const Context& context, const SolverBody& s) {
  if (s.inv_mass == 0.0) return nullptr;
  const Index island = context.step.island[s.body];
  const auto known = std::lower_bound(islands_.begin(), islands_.end(), island,
                                      [](const DeepIsland& deep, Index k) { return deep.island < k; });
  return known != islands_.end() && known->island == island ? &*known : nullptr;
}

// Takes the energy from the motions about the common centre first, which keeps the momentum.
void EnergyLimit::apply(const Context& context, SolverContacts& contacts) {
  for (DeepIsland& island : islands_) {
    double mass = 0.0, energy = 0.0;
    Vec3 momentum = Vec3::Zero();
    for (const SolverBody& s : contacts.bodies) {
      if (deepIslandOf(context, s) != &island) continue;
      island.energy += loadWork(context, s);
      mass += 1.0 / s.inv_mass, momentum += s.v / s.inv_mass, energy += kineticEnergy(context, s);
    }
    const double most =
        std::max(0.0, island.energy + 0.5 * mass * island.kinematic_speed * island.kinematic_speed);
    if (energy <= most) continue;
    const Vec3 common = momentum / mass;
    const double together = 0.5 * mass * common.squaredNorm(), apart = energy - together;
    const double share = apart > 0.0 ? std::sqrt(std::clamp((most - together) / apart, 0.0, 1.0)) : 0.0;
    const double rest = together > most ? std::sqrt(most / together) : 1.0;
    for (SolverBody& s : contacts.bodies)
      if (deepIslandOf(context, s) == &island) s.v = rest * common + share * (s.v - common), s.w *= share;
  }
}

}  // namespace rbs

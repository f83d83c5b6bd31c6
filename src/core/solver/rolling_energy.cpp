// SPDX-License-Identifier: BSD-3-Clause
#include "solver/rolling_energy.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs {

namespace {

// Whether a body of revolution rolls on another that is flat there.
bool rollsOn(const Context& context, const SolverBody& roller, const SolverBody& base) {
  const std::vector<Traits>& traits = context.scene.bodies.traits;
  const Traits& round = traits[roller.body];
  return roller.inv_mass > 0.0 && round.revolved && !round.round && !traits[base.body].revolved;
}

// What the points of a block have done to one of its bodies since the start, at most, J.
double workOn(const Context& context, const SolverContacts& contacts, const SolverBlock& block, bool on_j) {
  const SolverBody& other = contacts.bodies[on_j ? block.i : block.j];
  if (other.still) return 0.0;
  const Twist& before = context.scene.bodies.twist[other.body];
  double work = 0.0;
  for (int k = block.first; k < block.first + block.size; ++k) {
    const SolverPoint& point = contacts.points[k];
    const Vec3 p_W = (on_j ? 1.0 : -1.0) * SolverContacts::impulseOf(block, point);
    const Vec3& r = on_j ? point.r_i : point.r_j;
    work += std::max({0.0, p_W.dot(before.v_WB + before.w_WB.cross(r)), p_W.dot(other.v + other.w.cross(r))});
  }
  return work;
}

}  // namespace

void RollingEnergy::find(const Context& context, const SolverContacts& contacts) {
  for (const SolverBlock& block : contacts.blocks) {
    if (!block.rolls || block.pair.mu == 0.0) continue;
    for (const auto& [roller, base] : {std::pair(block.i, block.j), std::pair(block.j, block.i)})
      if (rollsOn(context, contacts.bodies[roller], contacts.bodies[base]))
        rollers_.push_back({roller, kineticEnergy(context, contacts.bodies[roller])});
  }
  std::sort(rollers_.begin(), rollers_.end(),
            [](const Roller& a, const Roller& b) { return a.body < b.body; });
  const auto same = [](const Roller& a, const Roller& b) { return a.body == b.body; };
  rollers_.erase(std::unique(rollers_.begin(), rollers_.end(), same), rollers_.end());
}

void RollingEnergy::apply(const Context& context, SolverContacts& contacts) const {
  if (rollers_.empty()) return;
  std::vector<double> most;
  for (const Roller& roller : rollers_)
    most.push_back(roller.energy + loadWork(context, contacts.bodies[roller.body]));
  for (const SolverBlock& block : contacts.blocks) {
    for (const bool on_j : {false, true}) {
      const auto roller = std::lower_bound(rollers_.begin(), rollers_.end(), on_j ? block.j : block.i,
                                           [](const Roller& a, Index body) { return a.body < body; });
      if (roller != rollers_.end() && roller->body == (on_j ? block.j : block.i))
        most[roller - rollers_.begin()] += workOn(context, contacts, block, on_j);
    }
  }
  for (std::size_t k = 0; k < rollers_.size(); ++k) {
    SolverBody& s = contacts.bodies[rollers_[k].body];
    const double gained = kineticEnergy(context, s) - most[k];
    if (gained > 0.0) s.w *= std::sqrt(std::max(0.0, 1.0 - gained / spinEnergy(context, s, s.w)));
  }
}

}  // namespace rbs

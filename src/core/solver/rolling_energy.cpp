// SPDX-License-Identifier: BSD-3-Clause
#include "solver/rolling_energy.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace rbs {

namespace {

// Sine of the angle between a normal and the axis of a cylinder or cone up to which it is that of a base.
constexpr double kBase = 1e-3;

// Whether a body of revolution rolls on another that is flat there.
bool rollsOn(const Context& context, const SolverBody& roller, const SolverBody& base, const Vec3& n_W) {
  const Bodies& bodies = context.scene.bodies;
  const Traits &round = bodies.traits[roller.body], &under = bodies.traits[base.body];
  if (roller.inv_mass == 0.0 || !round.revolved || round.round || under.round) return false;
  if (roller.inv_inertia_W.isZero(0.0)) return false;  // nothing changes its spin
  return !under.revolved || (under.edged && bodies.axis_W(base.body).cross(n_W).norm() <= kBase);
}

// What the points of a block have done to one of its bodies since the start, at most, as seen by one that moves at U, J.
double workOn(const Context& context, const SolverContacts& contacts, const SolverBlock& block, bool on_j,
              const Vec3& U_W) {
  const SolverBody& other = contacts.bodies[on_j ? block.i : block.j];
  if (other.still && U_W.isZero(0.0)) return 0.0;
  const Twist& before = context.scene.bodies.twist[other.body];
  const auto given = [&](const Vec3& impulse_W, const SolverPoint& at) {
    const Vec3 p_W = on_j ? impulse_W : Vec3(-impulse_W);
    const Vec3& r = on_j ? at.r_i : at.r_j;
    const Vec3 u_0 = before.v_WB + before.w_WB.cross(r) - U_W, u = other.v + other.w.cross(r) - U_W;
    return std::max({0.0, p_W.dot(u_0), p_W.dot(u)});
  };
  double work = 0.0;
  for (int k = block.first; k < block.first + block.size; ++k)
    work += given(SolverContacts::impulseOf(block, contacts.points[k]), contacts.points[k]);
  // Points that have opened count where the first one is that has not.
  if (block.size > 0) work += given(block.opened_W, contacts.points[block.first]);
  return work;
}

}  // namespace

void RollingEnergy::find(const Context& context, const SolverContacts& contacts) {
  for (const SolverBlock& block : contacts.blocks) {
    if (!block.rolls || block.pair.mu == 0.0) continue;
    for (const bool on_j : {false, true}) {
      const SolverBody& roller = contacts.bodies[on_j ? block.j : block.i];
      const SolverBody& base = contacts.bodies[on_j ? block.i : block.j];
      if (!rollsOn(context, roller, base, block.n)) continue;
      Vec3 U_W = base.v;
      if (block.size > 0) {
        const SolverPoint& point = contacts.points[block.first];
        U_W += base.w.cross(on_j ? point.r_i : point.r_j);
      }
      rollers_.push_back({on_j ? block.j : block.i, kineticEnergy(context, roller, U_W), U_W});
    }
  }
  // What lies on two bases has the energy that it has as seen from the one that gives it more.
  std::stable_sort(rollers_.begin(), rollers_.end(), [](const Roller& a, const Roller& b) {
    return std::tuple(a.body, -a.energy) < std::tuple(b.body, -b.energy);
  });
  const auto same = [](const Roller& a, const Roller& b) { return a.body == b.body; };
  rollers_.erase(std::unique(rollers_.begin(), rollers_.end(), same), rollers_.end());
}

void RollingEnergy::apply(const Context& context, double seconds, SolverContacts& contacts) const {
  if (rollers_.empty()) return;
  std::vector<double> most;
  for (const Roller& roller : rollers_) {
    const SolverBody& s = contacts.bodies[roller.body];
    most.push_back(roller.energy + loadWork(context, s, roller.U_W, seconds));
  }
  for (const SolverBlock& block : contacts.blocks) {
    for (const bool on_j : {false, true}) {
      const auto roller = std::lower_bound(rollers_.begin(), rollers_.end(), on_j ? block.j : block.i,
                                           [](const Roller& a, Index body) { return a.body < body; });
      if (roller != rollers_.end() && roller->body == (on_j ? block.j : block.i))
        most[roller - rollers_.begin()] += workOn(context, contacts, block, on_j, roller->U_W);
    }
  }
  for (std::size_t k = 0; k < rollers_.size(); ++k) {
    SolverBody& s = contacts.bodies[rollers_[k].body];
    const double gained = kineticEnergy(context, s, rollers_[k].U_W) - most[k];
    if (gained > 0.0) s.w *= std::sqrt(std::max(0.0, 1.0 - gained / spinEnergy(context, s, s.w)));
  }
}

}  // namespace rbs

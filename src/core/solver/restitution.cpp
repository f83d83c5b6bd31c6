// SPDX-License-Identifier: BSD-3-Clause
#include "solver/restitution.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

void push(SolverContacts& contacts, const SolverBlock& block, const SolverPoint& point, double impulse) {
  SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  const Vec3 impulse_W = impulse * block.n;
  i.v -= i.inv_mass * impulse_W;
  i.w -= impulse * (i.inv_inertia_W * SolverContacts::normalMoment(i, point.r_i, block.n));
  j.v += j.inv_mass * impulse_W;
  j.w += impulse * (j.inv_inertia_W * SolverContacts::normalMoment(j, point.r_j, block.n));
}

// The largest s in [0, 1] with a s² + b s + c <= 0; a >= 0. 0 where there is none.
double largestShare(double a, double b, double c) {
  if (a + b + c <= 0.0) return 1.0;
  if (c >= 0.0) return 0.0;
  const double root = std::sqrt(b * b - 4.0 * a * c);
  return std::clamp(b > 0.0 ? -2.0 * c / (b + root) : (root - b) / (2.0 * a), 0.0, 1.0);
}

}  // namespace

void Restitution::begin(const Context& context, const SolverContacts& contacts) {
  std::vector<Index> found;
  for (const SolverBlock& block : contacts.blocks)
    if (block.pair.e > 0.0) found.push_back(contacts.islandOf(block));
  islands_.begin(context, contacts, std::move(found));
}

void Restitution::apply(const Context& context, double seconds, SolverContacts& contacts) const {
  if (islands_.empty()) return;
  struct Rebound {
    const SolverBlock* block;
    SolverPoint* point;
    double impulse;
  };
  std::vector<Rebound> rebounds;
  std::vector<SolverBody> before;
  for (const SolverBlock& block : contacts.blocks) {
    if (block.pair.e == 0.0) continue;
    const double least = slowestRebound(context, block.n);
    for (int k = block.first; k < block.first + block.size; ++k) {
      SolverPoint& point = contacts.points[k];
      if (-block.pair.e * point.u_0 <= least || point.earlier_n + point.sum_n == 0.0) continue;
      const double u_n = contacts.normalVelocityAt(block, point);
      const double impulse = -point.mass_n * (u_n + block.pair.e * point.u_0);
      if (impulse <= 0.0) continue;
      if (before.empty()) before = contacts.bodies;
      push(contacts, block, point, impulse);
      rebounds.push_back({&block, &point, impulse});
    }
  }
  if (rebounds.empty()) return;

  const std::vector<double> shares = sharesOf(context, seconds, before, contacts.bodies);
  for (std::size_t k = 0; k < before.size(); ++k) {
    SolverBody& s = contacts.bodies[k];
    const Index place = islands_.placeOf(context, s);
    if (place == kNone) continue;
    s.v = before[k].v + shares[place] * (s.v - before[k].v);
    s.w = before[k].w + shares[place] * (s.w - before[k].w);
  }
  for (const Rebound& rebound : rebounds) {
    const SolverBody &i = contacts.bodies[rebound.block->i], &j = contacts.bodies[rebound.block->j];
    rebound.point->sum_n += shares[islands_.placeOf(context, i.inv_mass > 0.0 ? i : j)] * rebound.impulse;
  }
}

std::vector<double> Restitution::sharesOf(const Context& context, double seconds,
                                          const std::vector<SolverBody>& before,
                                          const std::vector<SolverBody>& after) const {
  struct Parabola {
    double a = 0.0, b = 0.0, c = 0.0;
  };
  std::vector<Parabola> gains(islands_.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    const Index place = islands_.placeOf(context, before[k]);
    if (place == kNone) continue;
    SolverBody change = after[k];
    change.v -= before[k].v, change.w -= before[k].w;
    const Vec3& U_W = islands_[place].U_W;
    const double had = kineticEnergy(context, before[k], U_W),
                 added = kineticEnergy(context, change, Vec3::Zero());
    gains[place].a += added;
    gains[place].b += kineticEnergy(context, after[k], U_W) - had - added;
    gains[place].c += had - loadWork(context, before[k], U_W, seconds);
  }
  std::vector<double> shares(islands_.size(), 1.0);
  for (Index k = 0; k < islands_.size(); ++k)
    if (islands_[k].kinematic_speed == 0.0)
      shares[k] = largestShare(gains[k].a, gains[k].b, gains[k].c - islands_[k].energy);
  return shares;
}

}  // namespace rbs

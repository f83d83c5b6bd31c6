// SPDX-License-Identifier: BSD-3-Clause
#include "solver/warm_start.h"

#include "solver/island_energy.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace rbs::warm_start {

namespace {

// Share of the energy of a body below which a gain is rounding.
constexpr double kRoundedEnergy = 1e-12;

struct Sum {
  double along = 0.0;     // l_0.u, J
  double response = 0.0;  // l_0.A l_0, J
  double most = 0.0;      // that it may add, J
  double share() const { return along + 0.5 * response <= most ? 1.0 : std::max(0.0, -along / response); }
};

// What a warm start may add to the energy of a body in a sub-step of h s, J.
double allowed(const Context& context, const SolverBody& s, double h) {
  const double fall = h * h * context.step.load[s.body].a_W.squaredNorm();
  const double radius = context.scene.bodies.traits[s.body].bounding_radius;
  const double energy = s.v_free.squaredNorm() + radius * radius * s.w_free.squaredNorm();
  return 0.5 * (kFalls * fall + kRoundedEnergy * energy) / s.inv_mass;
}

// Whether a warm start adds more to the energy of a body than it may. If it does so to none, it does not to an island on what is at
// rest. A bound on the gain spares most bodies their inertia: no moment is more than m R².
bool isFaster(const Context& context, const SolverBody& s, double h) {
  if (s.inv_mass == 0.0) return false;
  const Vec3 dw = s.w - s.w_free, sum = s.w + s.w_free;
  const double radius = context.scene.bodies.traits[s.body].bounding_radius;
  const double along = 0.5 * (s.v.squaredNorm() - s.v_free.squaredNorm()) / s.inv_mass;
  const double reach = 0.5 * radius * radius / s.inv_mass;
  const double most_spin = reach * reach * dw.squaredNorm() * sum.squaredNorm();
  if (along <= 0.0 && most_spin <= along * along) return false;
  const double most = allowed(context, s, h), left = most - along;
  if (left >= 0.0 && most_spin <= left * left) return false;
  const Quat q_BW = context.scene.bodies.pose[s.body].q_WB.conjugate();
  const Vec3& moments = context.scene.bodies.inertia[s.body].moments;
  return along + 0.5 * (q_BW * sum).dot(moments.cwiseProduct(q_BW * dw)) > most;
}

void addBody(const Context& context, const SolverBody& s, double h, Sum& sum) {
  const Quat q_BW = context.scene.bodies.pose[s.body].q_WB.conjugate();
  const Vec3 dv = s.v - s.v_free, w_B = q_BW * s.w_free, dw_B = q_BW * (s.w - s.w_free);
  const Vec3 moment_B = context.scene.bodies.inertia[s.body].moments.cwiseProduct(dw_B);
  sum.along += dv.dot(s.v_free) / s.inv_mass + moment_B.dot(w_B);
  sum.response += dv.squaredNorm() / s.inv_mass + moment_B.dot(dw_B);
  sum.most += allowed(context, s, h);
}

bool isKinematic(const SolverBody& s) {
  return s.inv_mass == 0.0 && !s.still;
}

// What the motion of kinematic bodies adds to l_0.u.
double workOfKinematic(const SolverContacts& contacts, const SolverBlock& block) {
  const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  double work = 0.0;
  for (int k = block.first; k < block.first + block.size; ++k) {
    const SolverPoint& point = contacts.points[k];
    const Vec3 p = point.l_n * block.n + point.l_t.x() * block.t1 + point.l_t.y() * block.t2;
    if (isKinematic(i)) work -= p.dot(i.v + i.w.cross(point.r_i));
    if (isKinematic(j)) work += p.dot(j.v + j.w.cross(point.r_j));
  }
  return work;
}

}  // namespace

void limit(const Context& context, SolverContacts& contacts, ContactLanes& lanes, double h) {
  std::vector<Index> found;
  for (const SolverBody& s : contacts.bodies)
    if (isFaster(context, s, h)) found.push_back(context.step.island[s.body]);
  // Of one on what moves, the energy is that seen from there; how fast all move together is to change nothing.
  for (const SolverBlock& block : contacts.blocks)
    if (isKinematic(contacts.bodies[block.i]) || isKinematic(contacts.bodies[block.j]))
      found.push_back(contacts.islandOf(block));
  if (found.empty()) return;
  SomeIslands islands;
  islands.set(std::move(found));

  std::vector<Sum> sums(islands.size());
  for (const SolverBody& s : contacts.bodies)
    if (const Index k = islands.placeOf(context, s); k != kNone) addBody(context, s, h, sums[k]);
  if (std::any_of(contacts.bodies.begin(), contacts.bodies.end(), isKinematic)) {
    lanes.writePoints();
    for (const SolverBlock& block : contacts.blocks)
      if (const Index k = islands.placeOf(contacts.islandOf(block)); k != kNone)
        sums[k].along += workOfKinematic(contacts, block);
  }
  if (std::all_of(sums.begin(), sums.end(), [](const Sum& sum) { return sum.share() == 1.0; })) return;

  for (SolverBody& s : contacts.bodies) {
    const Index k = islands.placeOf(context, s);
    if (k == kNone) continue;
    const double share = sums[k].share();
    s.v = s.v_free + share * (s.v - s.v_free);
    s.w = s.w_free + share * (s.w - s.w_free);
  }
  lanes.scaleImpulses([&](const SolverBlock& block) {
    const Index k = islands.placeOf(contacts.islandOf(block));
    return k == kNone ? 1.0 : sums[k].share();
  });
}

void leaveBearable(const Context& context, SolverContacts& contacts, ContactLanes& lanes,
                   const Softness& soft) {
  const std::vector<Contact>& active = context.scene.contacts.active;
  const auto isExact = [&](const SolverBlock& block) { return active[block.contact].exact; };
  if (std::none_of(contacts.blocks.begin(), contacts.blocks.end(), isExact)) return;
  lanes.writePoints();
  std::map<Index, double> shares;  // by island
  for (const SolverBlock& block : contacts.blocks) {
    if (!isExact(block)) continue;
    for (int k = block.first; k < block.first + block.size; ++k) {
      const SolverPoint& point = contacts.points[k];
      const double most = soft.mass / soft.impulse * point.mass_n * block.pair.push;
      if (point.l_n <= most) continue;
      double& share = shares.emplace(contacts.islandOf(block), 1.0).first->second;
      share = std::min(share, most / point.l_n);
    }
  }
  if (shares.empty()) return;
  const auto shareOf = [&](const SolverBlock& block) {
    const auto known = shares.find(contacts.islandOf(block));
    return known == shares.end() ? 1.0 : known->second;
  };
  lanes.scaleImpulses(shareOf);
  for (const SolverBlock& block : contacts.blocks)
    for (int k = block.first; k < block.first + block.size; ++k)
      contacts.points[k].warm_n *= shareOf(block), contacts.points[k].warm_t_W *= shareOf(block);
}

}  // namespace rbs::warm_start

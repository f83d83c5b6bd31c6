// SPDX-License-Identifier: BSD-3-Clause
#include "solver/energy_limit.h"

#include "base/tolerances.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

// Ratio of eigenvalues below which directions count as one: that of two at an angle a is tan(a/2)^2, 2e-3 rad here.
constexpr double kOneDirection = 1e-6;

// The projection on the span of directions of which m is the sum of d d^T.
Mat3 projectionOn(const Mat3& m) {
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(m);
  Mat3 projection = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] > kOneDirection * axes.eigenvalues()[2])
      projection += axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose();
  return projection;
}

}  // namespace

void EnergyLimit::find(const Context& context, const SolverContacts& contacts, bool all) {
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
  if (islands_.empty()) return;
  pushed_.assign(islands_.size(), Mat3::Zero());
  for (const SolverBlock& block : contacts.blocks) {
    const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
    if (i.inv_mass > 0.0 && j.inv_mass > 0.0) continue;
    const Index k = islands_.placeOf(context, i.inv_mass > 0.0 ? i : j);
    if (k != kNone)
      pushed_[k] += block.pair.mu > 0.0 ? Mat3(Mat3::Identity()) : Mat3(block.n * block.n.transpose());
  }
  for (Mat3& directions : pushed_)
    if (!directions.isZero(0.0)) directions = projectionOn(directions);
}

void EnergyLimit::apply(const Context& context, double seconds, SolverContacts& contacts) const {
  if (islands_.empty()) return;
  struct Sum {
    double mass = 0.0, energy = 0.0, given = 0.0, share = 1.0, rest = 1.0;
    Vec3 momentum = Vec3::Zero(), common = Vec3::Zero(),
         kept = Vec3::Zero();  // of common: what nothing outside pushes
  };
  std::vector<Sum> sums(islands_.size());
  for (Index k = 0; k < islands_.size(); ++k) sums[k].given = islands_[k].energy;
  for (const SolverBody& s : contacts.bodies) {
    const Index k = islands_.placeOf(context, s);
    if (k == kNone) continue;
    const Vec3& U_W = islands_[k].U_W;
    sums[k].given += loadWork(context, s, U_W, seconds);
    sums[k].mass += 1.0 / s.inv_mass, sums[k].momentum += (s.v - U_W) / s.inv_mass;
    sums[k].energy += kineticEnergy(context, s, U_W);
  }
  bool some = false;
  for (Index k = 0; k < islands_.size(); ++k) {
    Sum& sum = sums[k];
    const double kinematic_speed = islands_[k].kinematic_speed;
    const double most = std::max(0.0, sum.given + 0.5 * sum.mass * kinematic_speed * kinematic_speed);
    if (sum.energy <= most) continue;
    some = true;
    sum.common = sum.momentum / sum.mass;
    const double together = 0.5 * sum.mass * sum.common.squaredNorm(), apart = sum.energy - together;
    sum.share = apart > 0.0 ? std::sqrt(std::clamp((most - together) / apart, 0.0, 1.0)) : 0.0;
    const Vec3 pushed = pushed_[k] * sum.common;
    sum.kept = sum.common - pushed;
    const double left = std::max(0.0, most - 0.5 * sum.mass * sum.kept.squaredNorm());
    const double push = 0.5 * sum.mass * pushed.squaredNorm();
    sum.rest = push > left ? std::sqrt(left / push) : 1.0;
  }
  if (!some) return;
  for (SolverBody& s : contacts.bodies) {
    const Index k = islands_.placeOf(context, s);
    if (k == kNone || (sums[k].share == 1.0 && sums[k].rest == 1.0)) continue;
    const Sum& sum = sums[k];
    const Vec3& U_W = islands_[k].U_W;
    s.v = U_W + sum.kept + sum.rest * (sum.common - sum.kept) + sum.share * (s.v - U_W - sum.common);
    if (!s.inv_inertia_W.isZero(0.0)) s.w *= sums[k].share;  // nothing changes the spin of others
  }
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// A ball that rolls, or spins on the spot, is slowed by a torque about its contact, for which there are two
// numbers a body: c (rolling) and s (torsional). With R the radius of relative curvature, N the normal force
// and w the angular velocity of j against i, split along the normal n and across it,
//   |M_T| <= (c_i + c_j) R N,  against w_T;      |M_n| <= (s_i + s_j) R N,  against w_n:
// Coulomb's law with torques for forces (K. L. Johnson, "Contact Mechanics", 1985, 8.2 and 9.2, has what c
// comes from). For a ball of radius R on a plane it follows that it rolls to rest with a = -(5/7) c g, stays
// on a slope up to tan(slope) = c, and spins down with -(5/2) s g/R.
//
// A row is solved like friction in the soft step: the torque impulse that ends the turning, cut at its bound.
// What ends it depends on the contact. On one that sticks, friction answers a torque L and a slip u_T with
//   f = -S^-1 (u_T + B^T L),   A = I_i^-1 + I_j^-1,   B = I_i^-1 [r_i] T + I_j^-1 [r_j] T,   S^-1 = mass_t,
// T = (t1, t2), so that w becomes w - B S^-1 u_T + (A - B S^-1 B^T) L: for a ball on a plane, L does 2/7 of
// what it would do without friction. Solved so, a ball stops within a sub-step; with A alone it would take
// many.
//
// The exact step solves it together with the forces (coulomb/coulomb_problem.h, TorqueConstraint).
#include "solver/rolling.h"

#include "base/algebra.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace rbs::rolling {

namespace {

// Curvature of the surface of a body towards n_W, 1/m. A cylinder or cone has that of its side, and none
// where it stands on its base.
double curvature(const Bodies& bodies, Index i, const Vec3& n_W) {
  const Traits& t = bodies.traits[i];
  if (t.side_radius == 0.0) return 0.0;
  if (!t.edged) return 1.0 / t.side_radius;
  const double along = (bodies.pose[i].q_WB * Vec3::UnitZ()).dot(n_W);
  return std::max(1.0 - along * along, 0.0) / t.side_radius;
}

void apply(SolverBody& i, SolverBody& j, const Vec3& impulse_W) {
  i.w -= i.inv_inertia_W * impulse_W;
  j.w += j.inv_inertia_W * impulse_W;
}

}  // namespace

// A disc that tips from its rim onto its base is ever less curved towards the floor. From where R would be larger than the
// radius `largest` of either side it is largest²/R, which falls to 0: the points of the base resist instead.
double radius(const Bodies& bodies, Index i, Index j, const Vec3& n_W) {
  const double curved = curvature(bodies, i, n_W) + curvature(bodies, j, n_W);
  const double largest = std::max(bodies.traits[i].side_radius, bodies.traits[j].side_radius);
  return curved * largest < 1.0 ? curved * largest * largest : 1.0 / curved;
}

bool Resistance::takes(const Context& context, const Subgraph& batch) {
  const SceneStore& scene = context.scene;
  if (!scene.effects[Effect::Rolling]) return false;
  return std::any_of(batch.contacts.begin(), batch.contacts.end(), [&](Index k) {
    const Contact& contact = scene.contacts.active[k];
    return resists(scene, contact.i, contact.j);
  });
}

void Resistance::prepare(const Context& context, const Subgraph&, const SolverContacts& contacts, double) {
  const SceneStore& scene = context.scene;
  for (std::size_t k = 0; k < contacts.blocks.size(); ++k) {
    const SolverBlock& block = contacts.blocks[k];
    const Index i = contacts.bodies[block.i].body, j = contacts.bodies[block.j].body;
    if (!resists(scene, i, j)) continue;
    const double lever = radius(scene.bodies, i, j, block.n);
    if (lever == 0.0) continue;
    const auto [roll, spin] = coefficients(scene, i, j);
    rows_.push_back({k, roll * lever, spin * lever});
  }
}

void Resistance::warmStart(SolverContacts& contacts) const {
  for (const Row& row : rows_) {
    const SolverBlock& block = contacts.blocks[row.block];
    apply(contacts.bodies[block.i], contacts.bodies[block.j], row.l_W);
  }
}

// Every pass ends the turning: there is no position that the torque could keep.
void Resistance::solve(SolverContacts& contacts, Pass, const Softness&, double) {
  for (Row& row : rows_) solveRow(contacts, row);
}

void Resistance::solveRow(SolverContacts& contacts, Row& row) {
  const SolverBlock& block = contacts.blocks[row.block];
  SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  double pushed = 0.0;
  for (int k = block.first; k < block.first + block.size; ++k) pushed += contacts.points[k].l_n;
  if (pushed == 0.0 && row.l_W.isZero(0.0)) return;

  Eigen::Matrix<double, 3, 2> T;
  T << block.t1, block.t2;
  Mat3 response = i.inv_inertia_W + j.inv_inertia_W;
  Vec3 w = j.w - i.w;
  const double spin_limit = row.spin * pushed;
  const double spin = std::clamp(block.n.dot(row.l_W) - block.n.dot(w) / block.n.dot(response * block.n),
                                 -spin_limit, spin_limit);
  if (block.size == 1) {
    const SolverPoint& point = contacts.points[block.first];
    if (point.l_t.norm() < block.pair.mu * point.l_n) {
      const Eigen::Matrix<double, 3, 2> B =
          i.inv_inertia_W * crossMatrix(point.r_i) * T + j.inv_inertia_W * crossMatrix(point.r_j) * T;
      const Vec3 slip = j.v + j.w.cross(point.r_j) - i.v - i.w.cross(point.r_i);
      response -= B * point.mass_t * B.transpose();
      w -= B * (point.mass_t * (T.transpose() * slip));
    }
  }
  const Eigen::Matrix2d K = T.transpose() * response * T;
  const double roll_limit = row.roll * pushed;
  Eigen::Vector2d roll = T.transpose() * row.l_W - K.inverse() * (T.transpose() * w);
  if (roll.norm() > roll_limit) roll *= roll_limit / roll.norm();

  const Vec3 impulse_W = T * roll + spin * block.n;
  apply(i, j, impulse_W - row.l_W);
  row.l_W = impulse_W;
}

}  // namespace rbs::rolling

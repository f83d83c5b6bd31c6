// SPDX-License-Identifier: BSD-3-Clause
// Rolling and torsional resistance: the torques of a contact that is a small patch, not a point.
#pragma once

#include "solver/contact_lanes.h"
#include "solver/solver_contacts.h"

#include <limits>
#include <vector>

namespace rbs::rolling {

/// Whether a pair resists rolling or spinning: one of the two has a resistance, one is round, and one can be turned.
inline bool resists(const SceneStore& scene, Index i, Index j) {
  if (!scene.effects[Effect::Rolling]) return false;
  bool some = false, round = false, turns = false;
  for (const Index one : {i, j}) {
    const Traits& t = scene.bodies.traits[one];
    some |= t.material.rolling_resistance > 0.0 || t.material.torsional_resistance > 0.0;
    round |= t.side_radius > 0.0;
    turns |= !scene.bodies.inertia[one].inv_moments.isZero(0.0);
  }
  return some && round && turns;
}

/// The coefficients of a pair: the sums of those of its two bodies.
struct Coefficients {
  double roll, spin;
};
inline Coefficients coefficients(const SceneStore& scene, Index i, Index j) {
  const Material &a = scene.bodies.traits[i].material, &b = scene.bodies.traits[j].material;
  return {a.rolling_resistance + b.rolling_resistance, a.torsional_resistance + b.torsional_resistance};
}

/// The length R of a pair with this normal: 1/R = 1/R_i + 1/R_j, m; no larger than the larger radius of their
/// sides, and 0 where both are flat.
double radius(const Bodies& bodies, Index i, Index j, const Vec3& n_W);

/// The resistance of the contacts of a batch in the soft step, a kind of constraint of its own.
class Resistance {
 public:
  static void addEdges(const SceneStore&, std::vector<Edge>&) {}  // it acts between bodies in contact
  static bool takes(const Context& context, const Subgraph& batch);
  static double longestSubStep(const Context&, const Subgraph&) {
    return std::numeric_limits<double>::infinity();
  }
  void prepare(const Context& context, const Subgraph& batch, const SolverContacts& contacts, double h);
  bool empty() const { return rows_.empty(); }
  void warmStart(SolverContacts& contacts) const;
  void solve(SolverContacts& contacts, Pass pass, const Softness& soft, double h);
  void store(Context&) {}  // no step begins with the torques of the last one

 private:
  struct Row {
    std::size_t block;        // in SolverContacts::blocks
    double roll, spin;        // lever arms, m: torque over normal force
    Vec3 l_W = Vec3::Zero();  // impulse of its torque in this sub-step, on j, N m s
  };
  static void solveRow(SolverContacts& contacts, Row& row);

  std::vector<Row> rows_;
};

}  // namespace rbs::rolling

// Rolling and torsional resistance: the torques of a contact that is a small patch, not a point.
#pragma once

#include "methods/solver_contacts.h"

#include <vector>

namespace rbs::rolling {

/// Whether a pair resists rolling or spinning.
bool resists(const SceneStore& scene, Index i, Index j);

/// The resistance of one pair in the soft step.
struct Row {
  std::size_t block;           ///< in SolverContacts::blocks
  double roll, spin;           ///< lever arms, m: torque over normal force
  Vec3 l_W = Vec3::Zero();     ///< impulse of its torque in this sub-step, on j, N m s
};

std::vector<Row> find(const SceneStore& scene, const SolverContacts& contacts);
/// Gives the bodies the impulses of the last sub-step again.
void warmStart(SolverContacts& contacts, const std::vector<Row>& rows);
/// One pass over the rows.
void solve(SolverContacts& contacts, std::vector<Row>& rows);

}  // namespace rbs::rolling

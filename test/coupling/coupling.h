// SPDX-License-Identifier: BSD-3-Clause
// A kind of constraint that the program does not have: the tests add it as one adds any, by its own file and its name in
// solver/constraint_kinds.h (test/CMakeLists.txt).
#pragma once

#include "solver/contact_lanes.h"
#include "solver/residuals.h"
#include "solver/solver_contacts.h"
#include "state/context.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace rbs::test {

inline constexpr auto kCoupling = static_cast<ConstraintKind>(1);

/// Two bodies that move with one velocity and turn as they like: one named "coupled_to_NAME", and the body NAME.
class Coupling {
 public:
  static void addEdges(const SceneStore& scene, std::vector<Edge>& edges) {
    const std::string prefix = "coupled_to_";
    const std::vector<std::string>& names = scene.bodies.name;
    for (Index i = 0; i < names.size(); ++i) {
      if (names[i].compare(0, prefix.size(), prefix) != 0) continue;
      const auto other = std::find(names.begin(), names.end(), names[i].substr(prefix.size()));
      if (other != names.end())
        edges.push_back({kCoupling, i, {i, static_cast<Index>(other - names.begin()), kNone, kNone}});
    }
  }
  static bool takes(const Context&, const Subgraph& batch) { return !batch.edges.empty(); }
  static constexpr double kLongest = 2e-4;  // of a sub-step, s: 50 in a step
  static double longestSubStep(const Context&, const Subgraph& batch) {
    return batch.edges.empty() ? std::numeric_limits<double>::infinity() : kLongest;
  }
  void prepare(const Context& context, const Subgraph& batch, const SolverContacts& contacts, double h) {
    sub_steps_ = static_cast<int>(std::lround(context.step.h() / h));
    for (const Edge& edge : batch.edges)
      rows_.push_back({contacts.slotOf(edge.bodies[0]), contacts.slotOf(edge.bodies[1]), edge.bodies[0]});
  }
  bool empty() const { return rows_.empty(); }
  void warmStart(SolverContacts& contacts) const {
    for (const Row& row : rows_) push(contacts, row, row.impulse_W);
  }
  void solve(SolverContacts& contacts, Pass pass, const Softness&, double) {
    for (Row& row : rows_) {
      if (pass == Pass::Last) row.left = (contacts.bodies[row.i].v - contacts.bodies[row.j].v).norm();
      const SolverBody &i = contacts.bodies[row.i], &j = contacts.bodies[row.j];
      const Vec3 change_W = (i.v - j.v) / (i.inv_mass + j.inv_mass);
      push(contacts, row, change_W);
      row.impulse_W += change_W;
    }
  }
  void store(Context& context) const {
    for (const Row& row : rows_) {
      IslandResiduals solved;
      solved.method = "soft_step", solved.iterations = static_cast<std::uint32_t>(sub_steps_);
      solved.signorini = row.left;
      residuals::add(context.step.islands[context.step.island[row.body]].residuals, solved);
    }
  }

 private:
  struct Row {
    std::size_t i, j;
    Index body;
    Vec3 impulse_W = Vec3::Zero();  // on j, N s
    double left = 0.0;              // by how much the velocities differed in the last pass, m/s
  };
  static void push(SolverContacts& contacts, const Row& row, const Vec3& impulse_W) {
    contacts.bodies[row.i].v -= contacts.bodies[row.i].inv_mass * impulse_W;
    contacts.bodies[row.j].v += contacts.bodies[row.j].inv_mass * impulse_W;
  }
  std::vector<Row> rows_;
  int sub_steps_ = 0;
};

}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
#include "solver/residuals.h"

#include "state/out_of_bounds.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace rbs {

namespace residuals {

namespace {

// Kinetic and potential energy of a body.
double energyOf(const Context& context, Index i, const Pose& pose, const Twist& twist) {
  const Bodies& bodies = context.scene.bodies;
  return bodies.traits[i].mass * (0.5 * twist.v_WB.squaredNorm() - context.scene.gravity_W.dot(pose.p_WB)) +
         bodies.spinEnergy(i, pose.q_WB, twist.w_WB);
}

// From the most expensive to the cheapest.
int rank(std::string_view method) {
  constexpr std::array<std::string_view, 7> methods{"admm",      "interior_point", "newton", "gauss_seidel",
                                                    "soft_step", "warm_start",     ""};
  return static_cast<int>(std::find(methods.begin(), methods.end(), method) - methods.begin());
}

void checkIslands(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (Island& island : step.islands) {
    IslandResiduals& residuals = island.residuals;
    if (*residuals.method == 0) continue;
    for (const Index k : island.contacts) {
      const Contact& contact = context.scene.contacts.active[k];
      if (!contact.solved) continue;
      residuals.contacts += static_cast<std::uint32_t>(contact.points.size());
      for (const SolvedPoint& point : contact.points)
        residuals.deepest_penetration = std::max(residuals.deepest_penetration, -point.separation);
    }
    if (residuals.contacts == 0 && island.edges.empty()) continue;
    residuals.bodies = static_cast<std::uint32_t>(island.bodies.size());
    for (const Index i : island.bodies) {
      residuals.energy_change += energyOf(context, i, bodies.pose[i], bodies.twist[i]) -
                                 energyOf(context, i, step.before[i], step.twist_before[i]);
      residuals.turn = std::max(residuals.turn, step.h() * bodies.twist[i].w_WB.norm());
    }
    step.report.residuals.push_back(std::move(residuals));
  }
}

}  // namespace

void add(IslandResiduals& residuals, const IslandResiduals& solve) {
  if (rank(solve.method) < rank(residuals.method)) residuals.method = solve.method;
  residuals.iterations += solve.iterations;
  residuals.signorini = std::max(residuals.signorini, solve.signorini);
  residuals.coulomb = std::max(residuals.coulomb, solve.coulomb);
  residuals.dissipation = std::max(residuals.dissipation, solve.dissipation);
  residuals.converged = residuals.converged && solve.converged;
}

Need need(const SceneAnalysis& c) {
  if (c.moved_by_forces == c.ballistic && c.kinematic == 0) return {false, "no body can leave its parabola"};
  return {true, "the solver residuals of every island are checked in every step"};
}

void check(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (const std::vector<Index>* list : {&context.scene.lists.in_islands, &context.scene.lists.kinematic})
    for (const Index i : *list)
      if (!withinLimits(bodies.pose[i], bodies.twist[i]))
        bringBack(context, i, step.before[i], step.twist_before[i]);

  for (const Contact& contact : context.scene.contacts.active) {
    step.report.axis_queries += contact.axis.queries, step.report.axes_kept += contact.axis.kept;
    if (!contact.solved) continue;
    step.report.contacts += static_cast<std::uint32_t>(contact.points.size());
    for (const SolvedPoint& point : contact.points)
      step.report.deepest_penetration = std::max(step.report.deepest_penetration, -point.separation);
  }
  checkIslands(context);
}

}  // namespace residuals
}  // namespace rbs

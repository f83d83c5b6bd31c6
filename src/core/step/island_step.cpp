// SPDX-License-Identifier: BSD-3-Clause
#include "step/island_step.h"

#include "base/algebra.h"
#include "base/text.h"
#include "solver/methods.h"

#include <algorithm>
#include <limits>

namespace rbs {

namespace {

// Contact forces that an exact setting does not find do not exist, as where moving bodies leave another one
// no room; or they are out of reach of its solvers. The name of a kinematic body in contact tells the first.
void reportUnsolved(const Context& context, const IslandBatch& batch, Island& island) {
  const Bodies& bodies = context.scene.bodies;
  const Contact* squeezes = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : batch.edges) {
    if (edge.kind != ConstraintKind::Contact) continue;
    const Contact& contact = context.scene.contacts.active[edge.of];
    if (!bodies.traits[contact.i].is_kinematic() && !bodies.traits[contact.j].is_kinematic()) continue;
    for (const SolvedPoint& point : contact.points)
      if (point.separation < nearest) nearest = point.separation, squeezes = &contact;
  }
  if (squeezes == nullptr) {
    island.warnings.push_back(
        {"unsolved",
         "no contact forces hold the group of body '" + bodies.name[batch.bodies.front()] +
             "' as Coulomb's law asks; soft contacts take it through the step. Shorten the step, or "
             "move apart what overlaps"});
    return;
  }
  const bool first = bodies.traits[squeezes->i].is_kinematic();
  island.warnings.push_back(
      {"unsolved",
       "kinematic body '" + bodies.name[first ? squeezes->i : squeezes->j] + "' leaves body '" +
           bodies.name[first ? squeezes->j : squeezes->i] +
           "' no room, and no contact force can hold both; contacts that give way let them overlap. Stop "
           "the kinematic body, or make it dynamic"});
}

void reportCutShort(Context& context, const Island& island) {
  context.step.report.warnings.push_back(
      {"solve_budget", "the contact forces in the group of body '" +
                           context.scene.bodies.name[island.bodies.front()] + "' (" +
                           count(island.bodies.size(), "body", "bodies") +
                           ") take more work than a step may, so they are approximate. Shorten the step, or "
                           "choose a faster setting"});
}

// By the exact step, and by the soft step where that one cannot. An island that is too dear stays with the
// soft step until the end of the step.
void advanceExactly(Context& context, const IslandBatch& batch, double t0, double t1) {
  Island& island = context.step.islands[context.step.island[batch.bodies.front()]];
  const exact_step::Outcome outcome = exact_step::advance(context, batch, t0, t1);
  using exact_step::Outcome;
  if (outcome == Outcome::Done) return;
  if (outcome == Outcome::TooDear) island.exact = false;
  if (outcome != Outcome::NoRoom) soft_step::advance(context, batch, t0, t1);
  if (context.step.solver.exact && outcome != Outcome::TooDear) reportUnsolved(context, batch, island);
}

void advanceBatch(Context& context, const IslandBatch& batch, bool exact, double t0, double t1) {
  if (!(t1 > t0) || batch.bodies.empty()) return;
  if (batch.edges.empty()) {
    flight::advance(context, batch, t0, t1);
  } else if (exact) {
    advanceExactly(context, batch, t0, t1);
  } else {
    soft_step::advance(context, batch, t0, t1);
  }
}

// Whether an island is advanced by sub-steps of its own.
bool isHasty(const Context& context, const Island& island) {
  return soft_step::longestSubStep(context, island.edges) < context.step.h() / context.step.solver.sub_steps;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void advanceTo(Context& context, Island& island, double time) {
  advanceBatch(context, {island.bodies, island.edges}, island.exact, island.time, time);
  island.time = std::max(island.time, time);
}

void advanceToEnd(Context& context) {
  StepStore& step = context.step;
  struct Together {
    std::vector<Index> bodies;
    std::vector<Edge> edges;
  } flying, connected;
  for (Island& island : step.islands) {
    if (island.time >= step.t1) continue;
    const bool alone = !island.flies() && (island.exact || isHasty(context, island));
    if (island.time > step.t0 || alone) {
      advanceTo(context, island, step.t1);
    } else {
      Together& batch = island.flies() ? flying : connected;
      append(batch.bodies, island.bodies);
      append(batch.edges, island.edges);
      island.time = step.t1;
    }
  }
  std::sort(connected.edges.begin(), connected.edges.end());
  advanceBatch(context, {flying.bodies, flying.edges}, false, step.t0, step.t1);
  advanceBatch(context, {connected.bodies, connected.edges}, false, step.t0, step.t1);
}

void reportIslands(Context& context) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  StepReport& report = step.report;
  for (const Island& island : step.islands) {
    if (island.bodies.empty()) continue;
    report.flying += island.flies() ? static_cast<std::uint32_t>(island.bodies.size()) : 0;
    report.islands += island.flies() ? 0 : 1;
    report.impacts += island.impacts;
    report.deferred_impacts += island.deferred_impacts;
    append(report.warnings, island.warnings);
    if (step.solver.exact && island.cut_short && !island.residuals.converged) reportCutShort(context, island);
    const BodyId oldest = bodies.id[*std::min_element(island.bodies.begin(), island.bodies.end())];
    const char* const method = *island.residuals.method != 0 ? island.residuals.method : "flight";
    for (const Index i : island.bodies) bodies.advance[i] = {method, oldest};
  }
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "step/island_step.h"

#include "base/algebra.h"
#include "base/text.h"
#include "solver/inner_step.h"
#include "solver/methods.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace rbs {

namespace {

// Contact forces that an exact setting does not find do not exist, as where moving bodies leave another one
// no room; or they are out of reach of its solvers. A kinematic body that closes on another one tells the first. Said once a
// step.
void reportUnsolved(const Context& context, const Subgraph& batch, Island& island) {
  const auto isSaid = [](const Warning& warning) { return warning.kind == "unsolved"; };
  if (std::any_of(island.warnings.begin(), island.warnings.end(), isSaid)) return;
  const Bodies& bodies = context.scene.bodies;
  const Contact* squeezes = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Index k : batch.contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    if (!bodies.traits[contact.i].is_kinematic() && !bodies.traits[contact.j].is_kinematic()) continue;
    for (const SolvedPoint& point : contact.points) {
      const auto speedOf = [&](Index i) {
        if (!bodies.traits[i].is_kinematic()) return 0.0;
        return point.n_W.dot(velocityAt(bodies.twist[i], point.p_W - bodies.pose[i].p_WB));
      };
      const bool closes = speedOf(contact.i) > speedOf(contact.j);
      if (closes && point.separation < nearest) nearest = point.separation, squeezes = &contact;
    }
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

// The soft step takes an island that the exact step could not take. One that is over its budget stays with it until the end of
// the step.
void finishExact(Context& context, const Subgraph& batch, exact_step::Outcome outcome, double t0, double t1) {
  Island& island = context.step.islands[context.step.island[batch.bodies.front()]];
  using exact_step::Outcome;
  if (outcome == Outcome::Done) return;
  if (outcome == Outcome::OverBudget) island.exact = false;
  if (outcome != Outcome::NoRoom) soft_step::advance(context, batch, t0, t1);
  if (context.step.solver.exact && outcome != Outcome::OverBudget) reportUnsolved(context, batch, island);
}

void advanceBatch(Context& context, const Subgraph& batch, bool exact, double t0, double t1) {
  if (!(t1 > t0) || batch.bodies.empty()) return;
  if (batch.flies()) {
    flight::advance(context, batch, t0, t1);
  } else if (exact) {
    finishExact(context, batch, exact_step::advance(context, batch, t0, t1), t0, t1);
  } else {
    soft_step::advance(context, batch, t0, t1);
  }
}

// Whether an island is advanced by sub-steps of its own.
bool needsOwnSubSteps(const Context& context, const Island& island) {
  return soft_step::longestSubStep(context, island) < context.step.h() / context.step.solver.sub_steps;
}

}  // namespace

void advanceTo(Context& context, Island& island, double time) {
  advanceBatch(context, island, island.exact, island.time, time);
  island.time = std::max(island.time, time);
  for (const Index k : island.contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    if (contact.solved && contact.bears())
      context.step.touched[contact.i] = context.step.touched[contact.j] = 1;
  }
}

namespace {

// Islands that the exact step solves. Threads share those that need no more work than they have of their own; the others
// take of the common work in their order, as they do on one thread. Where threads work side by side, the wall time of all is
// charged to the rows in the ratio of their own times.
void advanceExact(Context& context, const std::vector<Island*>& islands) {
  StepStore& step = context.step;
  std::vector<std::optional<exact_step::Outcome>> outcomes(islands.size());
  if (step.workers->count() > 1 && islands.size() > 1) {
    std::vector<std::vector<double>> row_seconds(islands.size(), std::vector<double>(kInnerRows, 0.0));
    const auto begin = std::chrono::steady_clock::now();
    step.workers->share(islands.size(), 1, [&](std::size_t k, auto, auto) {
      const Island& island = *islands[k];
      outcomes[k] = exact_step::advanceByItsOwn(context, island, island.time, step.t1, row_seconds[k]);
    });
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    double sum = 0.0;
    for (const std::vector<double>& one : row_seconds) sum += std::accumulate(one.begin(), one.end(), 0.0);
    for (const std::vector<double>& one : row_seconds)
      for (std::size_t row = 0; row < kInnerRows; ++row)
        step.row_seconds[row] += sum > 0.0 ? wall / sum * one[row] : 0.0;
  }
  for (std::size_t k = 0; k < islands.size(); ++k) {
    Island& island = *islands[k];
    if (!outcomes[k]) outcomes[k] = exact_step::advance(context, island, island.time, step.t1);
    finishExact(context, island, *outcomes[k], island.time, step.t1);
    island.time = step.t1;
  }
}

}  // namespace

void advanceToEnd(Context& context) {
  StepStore& step = context.step;
  std::vector<Island*> exact;
  Subgraph flying, connected, with_other_kinds;
  for (Island& island : step.islands) {
    if (island.time >= step.t1) continue;
    if (!island.flies() && island.exact) {
      exact.push_back(&island);
    } else if (island.time > step.t0 || (!island.flies() && needsOwnSubSteps(context, island))) {
      advanceTo(context, island, step.t1);
    } else {
      (island.flies()                              ? flying
       : soft_step::hasOtherKinds(context, island) ? with_other_kinds
                                                   : connected)
          .append(island);
      island.time = step.t1;
    }
  }
  advanceExact(context, exact);
  advanceBatch(context, flying, false, step.t0, step.t1);
  for (Subgraph* const batch : {&connected, &with_other_kinds}) {
    std::sort(batch->contacts.begin(), batch->contacts.end());
    std::sort(batch->edges.begin(), batch->edges.end());
    advanceBatch(context, *batch, false, step.t0, step.t1);
  }
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
    report.warnings.insert(report.warnings.end(), island.warnings.begin(), island.warnings.end());
    if (step.solver.exact && island.cut_short && !island.residuals.converged) reportCutShort(context, island);
    const BodyId oldest = bodies.id[*std::min_element(island.bodies.begin(), island.bodies.end())];
    const char* const method = *island.residuals.method != 0 ? island.residuals.method : "flight";
    for (const Index i : island.bodies) bodies.advance[i] = {method, oldest};
  }
}

}  // namespace rbs

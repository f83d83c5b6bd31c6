// SPDX-License-Identifier: BSD-3-Clause
#include "step/step_controller.h"

#include "step/impact_loop.h"
#include "step/island_step.h"
#include "step/islands.h"
#include "step/missed_contacts.h"

#include <algorithm>

namespace rbs::step_controller {

namespace {

// What a step changes, as it is before any body moves.
struct Beginning {
  Contacts contacts;
  std::vector<Bounds> bounds;
  StepReport report;
};

// Puts the step back to its beginning, but for these pairs, which contacts are to solve with.
void beginAgain(Context& context, Beginning& beginning, const std::vector<std::pair<Index, Index>>& pairs) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (const Index i : context.scene.lists.in_islands)
    bodies.pose[i] = step.before[i], bodies.twist[i] = step.twist_before[i];
  for (const auto& [i, j] : pairs) beginning.contacts.open(bodies, i, j);
  context.scene.contacts = beginning.contacts;
  step.bounds = beginning.bounds;
  step.report = beginning.report;
  std::fill(step.stamp.begin(), step.stamp.end(), 0);
  step.islands.clear();
  islands::build(context);
}

// Whether contacts may push something: some are there, or impacts may leave bodies in contact.
bool mayMissContacts(const Context& context) {
  const StepStore& step = context.step;
  if (!step.solver.exact || context.scene.lists.in_islands.size() < 2) return false;
  const std::vector<Contact>& contacts = context.scene.contacts.active;
  const auto stays = [&](const Contact& contact) {
    return context.scene.restitutionOf(contact.i, contact.j) == 0.0;
  };
  const auto isConnected = [](const Island& island) { return !island.flies(); };
  return std::any_of(step.islands.begin(), step.islands.end(), isConnected) ||
         (!step.impacts.empty() && std::any_of(contacts.begin(), contacts.end(), stays));
}

// Contacts push bodies off the motion on which they were predicted to pass others. Where that makes a pair
// overlap, the step is taken again with this pair among the contacts.
void advanceUntilNoneIsMissed(Context& context) {
  constexpr int kMostTimes = 8;  // each push may reach one body further
  Beginning beginning{context.scene.contacts, context.step.bounds, context.step.report};
  for (int times = 1;; ++times) {
    takeImpacts(context);
    advanceToEnd(context);
    if (times == kMostTimes || context.step.solve_budget.isLate()) return;
    const std::vector<std::pair<Index, Index>> missed = findMissedContacts(context);
    if (missed.empty()) return;
    beginAgain(context, beginning, missed);
    // All repetitions together cost no more than one begun anew.
    for (Island& island : context.step.islands) island.work >>= times;
  }
}

void moveLedBodies(Context& context) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : context.scene.lists.kinematic)
    bodies.pose[i] = context.step.poseAt(bodies, i, context.step.t1);
}

}  // namespace

void run(Context& context) {
  if (mayMissContacts(context)) {
    advanceUntilNoneIsMissed(context);
  } else {
    takeImpacts(context);
    advanceToEnd(context);
  }
  moveLedBodies(context);
}

}  // namespace rbs::step_controller

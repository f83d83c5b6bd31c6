// SPDX-License-Identifier: BSD-3-Clause
#include "step/step_controller.h"

#include "step/impact_loop.h"
#include "step/island_step.h"
#include "step/missed_contacts.h"
#include "step/restart.h"

#include <algorithm>

namespace rbs::step_controller {

namespace {

// Whether contacts may push something: some are there, or impacts may leave bodies in contact.
bool mayMissContacts(const Context& context) {
  const StepStore& step = context.step;
  if (context.scene.lists.in_islands.size() < 2) return false;
  const std::vector<Contact>& contacts = context.scene.contacts.active;
  const auto stays = [&](const Contact& contact) {
    return context.scene.restitutionOf(contact.i, contact.j) == 0.0;
  };
  const auto isConnected = [](const Island& island) { return !island.flies(); };
  return std::any_of(step.islands.begin(), step.islands.end(), isConnected) ||
         (!step.impacts.empty() && std::any_of(contacts.begin(), contacts.end(), stays));
}

void advanceUntilNoneIsMissed(Context& context) {
  constexpr int kMostTimes = 8;  // each push may reach one body further
  Restart restart(context);
  for (int times = 1;; ++times) {
    takeImpacts(context);
    advanceToEnd(context);
    if (times == kMostTimes || context.step.solve_budget.isLate()) return;
    IndexPairs missed = findMissedContacts(context);
    missed.insert(missed.end(), context.step.late.begin(), context.step.late.end());
    if (missed.empty() && context.step.reached.empty()) return;
    restart.beginAgain(context, missed, times);
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
  reportIslands(context);
  context.step.met.clear();
}

}  // namespace rbs::step_controller

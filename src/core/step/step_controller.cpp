// SPDX-License-Identifier: BSD-3-Clause
#include "step/step_controller.h"

#include "base/text.h"
#include "step/early_impacts.h"
#include "step/impact_loop.h"
#include "step/impacts.h"
#include "step/island_step.h"
#include "step/missed_contacts.h"
#include "step/restart.h"
#include "step/sleep.h"

#include <algorithm>
#include <string>

namespace rbs::step_controller {

namespace {

// Whether contacts may push something, or something comes where it was not expected: contacts are there; or impacts may leave
// bodies in contact, as those do that lose energy, or send something into a sleeper; or drag or a torque changes a way.
bool mayMissContacts(const Context& context) {
  const StepStore& step = context.step;
  const auto isConnected = [](const Island& island) { return !island.flies(); };
  if (std::any_of(step.islands.begin(), step.islands.end(), isConnected)) return true;
  if (step.impacts.empty() && !mayMeetUnforeseen(context)) return false;
  if (context.analysis.asleep > 0 || !step.load_without_drag.empty()) return true;
  const std::vector<Contact>& contacts = context.scene.contacts.active;
  const std::vector<Index>& moved = context.scene.lists.in_islands;
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const Contact& contact) {
                       return impacts::losesEnergy(context.scene, contact.i, contact.j);
                     }) ||
         std::any_of(moved.begin(), moved.end(), [&](Index i) { return !step.load[i].torque_W.isZero(0.0); });
}

// Whether some of these pairs are with sleepers, which are to wake.
bool wakeAmong(Context& context, const IndexPairs& pairs) {
  std::vector<Index> sleepers;
  for (const auto& [i, j] : pairs)
    for (const Index k : {i, j})
      if (context.scene.bodies.traits[k].asleep) sleepers.push_back(k);
  sleep::wakeGroups(context, sleepers);
  return !sleepers.empty();
}

// How often a step is taken at most.
constexpr int kMostTimes = 3, kMostTimesExact = 8;

// At the exact settings no overlap is left in silence.
void reportMissed(Context& context, const IndexPairs& missed, int times) {
  const std::vector<std::string>& names = context.scene.bodies.name;
  for (const auto& [i, j] : missed)
    context.step.report.warnings.push_back(
        {"missed_contact", "contacts push body '" + names[i] + "' into or through body '" + names[j] +
                               "' in a step that was taken " + count(times, "time", "times") +
                               ". Shorten the step"});
}

// Each push may reach one body further. At the fast settings what is left after a few times is left to the next step.
void advanceUntilNoneIsMissed(Context& context) {
  const bool exact = context.step.solver.exact;
  const int most_times = exact ? kMostTimesExact : kMostTimes;
  Restart restart(context);
  for (int times = 1;; ++times) {
    takeImpacts(context);
    sleep::wakeGroups(context, context.step.disturbed);
    if (!context.step.disturbed.empty()) return restart.giveBack(context);
    advanceToEnd(context);
    const bool last = times == most_times || context.step.solve_budget.isLate();
    IndexPairs missed = last ? IndexPairs() : findMissedContacts(context);
    if (wakeAmong(context, missed)) return restart.giveBack(context);
    missed.insert(missed.end(), context.step.overlapping.begin(), context.step.overlapping.end());
    if (last && exact) reportMissed(context, findMissedContacts(context), times);
    if (last || (missed.empty() && context.step.reached.empty())) return;
    restart.beginAgain(context, missed, times);
  }
}

void moveKinematicBodies(Context& context) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : context.scene.lists.kinematic)
    bodies.pose[i] = context.step.poseAt(bodies, i, context.step.t1);
}

}  // namespace

void advanceIslands(Context& context) {
  if (mayMissContacts(context)) {
    advanceUntilNoneIsMissed(context);
  } else {
    takeImpacts(context);
    advanceToEnd(context);
  }
  if (!context.step.woken.empty()) return;  // the step begins again, with more bodies awake
  moveKinematicBodies(context);
  reportIslands(context);
  context.step.impacted.clear();
}

}  // namespace rbs::step_controller

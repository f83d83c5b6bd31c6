// SPDX-License-Identifier: BSD-3-Clause
// The rollback of a step, island by island.
//
// Contacts push bodies off the motion on which they were predicted to pass others. Where that brings a pair
// together, the step begins again with this pair among the contacts; but only for the bodies whose motion may
// be another with it. A body may have felt what another did in the step where the broad phase or an impact
// found the two near each other, or a constraint ties them. What these relations connect with the pair begins
// again, and all other bodies stay where the step has brought them.
//
// Bodies and pair states are put back as they were; but a pair that rested apart is a candidate, since contacts may push it
// together. The points that the solver has left in the contacts stay, as a warm start that is nearer than that of the last
// step; their impulses do not count.
#pragma once

#include "state/context.h"

#include <utility>
#include <vector>

namespace rbs {

/// What is kept of the start of a step. The next step takes over its memory.
struct RestartStores {
  struct Known {
    Index i, j;
    PairState state;
  };
  std::vector<Known> known;  ///< active contacts, sorted; those that were missed are added
  /// Impulses of earlier divisions of the step, by contact.
  std::vector<std::pair<ContactKey, std::vector<SolvedPoint>>> earlier;
  std::vector<PendingImpact> impacts;
  std::vector<Load> load;  ///< by body, where there is drag, which impacts change; else empty
};

/// What is known at the start of a step, before any body moves.
class Restart {
 public:
  explicit Restart(Context& context);

  /// Puts the bodies that missed pairs and step.reached concern back to the beginning of the step, and makes
  /// their islands anew with the missed pairs among the contacts. `times` is how often the step has been taken:
  /// the n-th repetition of an exact solve gets 1/2^n of its allowance, so that all together cost less than one more solve.
  /// Costs n bodies and all contacts.
  void beginAgain(Context& context, const IndexPairs& missed, int times);

  /// Puts all bodies and contacts back to the beginning of the step.
  void giveBack(Context& context);

 private:
  using Known = RestartStores::Known;

  std::vector<Known>::iterator placeOf(Index i, Index j);
  bool isKnown(std::vector<Known>::iterator place, Index i, Index j) const;
  void restoreContacts(Context& context, const IndexPairs& missed, const std::vector<char>& again);

  RestartStores& at_start_;
};

}  // namespace rbs

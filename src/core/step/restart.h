// SPDX-License-Identifier: BSD-3-Clause
// The rollback of a step, island by island.
//
// Contacts push bodies off the motion on which they were predicted to pass others. Where that makes a pair
// overlap, the step begins again with this pair among the contacts; but only for the bodies whose motion may
// be another with it. A body may have felt what another did in the step where the broad phase or an impact
// found the two near each other, or a constraint ties them. What these relations connect with the pair begins
// again, and all other bodies stay where the step has brought them.
#pragma once

#include "state/context.h"

#include <utility>
#include <vector>

namespace rbs {

/// What a step changes, as it is before any body moves.
class Restart {
 public:
  explicit Restart(const Context& context);

  /// Puts the bodies that these pairs and step.reached concern back to the beginning of the step, and makes
  /// their islands anew with these pairs among the contacts. `times` is how often a step has been taken: all repetitions of an
  /// exact solve together cost no more than one begun anew. Costs n bodies and all contacts.
  void beginAgain(Context& context, const IndexPairs& pairs, int times);

 private:
  void restoreContacts(Context& context, const std::vector<char>& again);

  Contacts contacts_;
  std::vector<Bounds> bounds_;
  std::vector<PendingImpact> impacts_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The contacts of islands while the impacts of a step are taken: pairs that come to touch become constraints, and the
// islands of their bodies one.
#pragma once

#include "state/context.h"
#include "step/impact_budget.h"

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace rbs {

class IslandContacts {
 public:
  IslandContacts(Context& context, ImpactBudget& budget);

  /// The place of the contact of a pair, in any order, in scene.contacts.active; kNone: it has none.
  Index find(Index i, Index j) const;
  /// Whether an island has this contact as a constraint. A contact that came to await an impact stays one, and is left out
  /// of solves.
  bool isConstraint(Index contact) const { return contact < has_edge_.size() && has_edge_[contact]; }
  /// Where the impulses of an impact of the pair are kept. The two may have been too far apart for a contact when the step
  /// began.
  Contact& contactOf(Index i, Index j);
  /// Leaves a pair that touches, or may touch, to the contact solver for the rest of the step, and makes one island of
  /// the two. Forces move one of the bodies at least. The island that is behind is advanced to the time of the other. Where
  /// the budget does not allow that, the clock of the other is set back.
  void connect(Index i, Index j, bool touches = true);
  /// Of a pair that does not touch and has no pending impact: it is separated where both trajectories are known, else the
  /// contact solver's business.
  void separateOrConnect(Index i, Index j);
  /// A sleeper that comes into play is a wall in this attempt. The step is to begin again with it awake.
  void disturb(Index i, Index j);
  /// Leaves the separated pairs whose moved body is wanted to the contact solver. Whether there were any. At the exact settings no
  /// large group is advanced for that, since others of its pairs would meet unseen: what flies ahead of it is set back.
  bool connectSeparated(const std::function<bool(Index)>& isWanted);
  /// Sets the clock of the island of body j back to that of body i, which is behind. Its bodies stay where they are and live through
  /// the time again, with the loads and contacts of that time. So they go a little further in this step than its length. A body that
  /// touches nothing goes back as if it had moved along with the centre of body i since then: on a sled it stays where it is on that.
  /// At the exact settings it goes back without what its load has done.
  void setBack(Index j, Index i);
  /// Whether that breaks no balance at the exact settings, and gains no energy.
  bool mayGoBack(Index j, Index i) const;
  /// The bodies whose clock was set back since the last call: what was predicted of them comes too late.
  std::vector<Index> takeSetBack() { return std::exchange(set_back_, {}); }

 private:
  Index placeOf(Index i, Index j);  // it is added where it is not there
  void bringTogether(Index i, Index j);

  Context& context_;
  StepStore& step_;
  Contacts& contacts_;
  ImpactBudget& budget_;
  std::size_t found_;           // pairs of the broad phase; later ones are not sorted
  std::vector<char> has_edge_;  // by contact
  std::vector<Index> set_back_;
};

}  // namespace rbs

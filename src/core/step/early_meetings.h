// SPDX-License-Identifier: BSD-3-Clause
// What contacts bring together before its time.
//
// Impacts are predicted as if each body went on alone. In an island that is brought to an impact its contacts have
// pushed bodies off that course, and two that no contact keeps apart may be in each other: the impact between them would
// come late, from inside. So the island goes back, and both are looked at when they were about to touch. With the
// separations s_0 > 0 where the island begins and s_1 < 0 where the impact is, that is, as of a steady approach, at
//   t = t_0 + (t_1 - t_0) s_0/(s_0 - s_1).
// From there the two are predicted anew. What contacts do to them in the little time that is left is little.
#pragma once

#include "state/context.h"

#include <functional>
#include <optional>
#include <vector>

namespace rbs {

/// An island as it is now, to be put back.
class IslandBefore {
 public:
  IslandBefore(const Context& context, const Island& island);
  /// Puts all back but the work that its solves have cost.
  void putBack(Context& context) const;

 private:
  Index place_;
  Island island_;
  std::vector<Pose> poses_;
  std::vector<Twist> twists_;
  std::vector<Contact> contacts_;  // of its edges
};

/// Brings an island to `time` as advanceTo() does, and looks at the pairs that `others` gives for a body of it: bodies that
/// no contact keeps apart from it. Where some of them overlap then and did not before, the island is put back,
/// and this is the first time at which a pair is to be looked at, with the pair. Costs a solve more then, and 1 us a pair.
std::optional<PendingImpact> advanceUnlessEarly(Context& context, Island& island, double time,
                                                const std::function<std::vector<Index>(Index)>& others);

}  // namespace rbs

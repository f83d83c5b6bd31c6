// SPDX-License-Identifier: BSD-3-Clause
// The forces of the contacts of the last step, by body, for effects that tell how a body will move.
#pragma once

#include "state/context.h"

#include <vector>

namespace rbs {

/// An impact does not last: a force counts up to twice the load that it answers to.
class ContactForces {
 public:
  ContactForces() = default;  ///< none
  explicit ContactForces(const Context& context);
  /// N, in W.
  Vec3 on(Index i, const Vec3& load_W) const;

 private:
  std::vector<Vec3> forces_W_;  // empty: nothing is carried
};

}  // namespace rbs

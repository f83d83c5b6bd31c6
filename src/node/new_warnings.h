// SPDX-License-Identifier: BSD-3-Clause
// NewWarnings: hands out each warning of a simulation once, however many steps go by between two looks.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rbs {

class NewWarnings {
 public:
  /// Those since the last call, as far as the snapshot has them, the oldest first.
  std::vector<Warning> take(const Snapshot& snapshot) {
    std::vector<Warning> taken;
    for (const NumberedWarning& one : *snapshot.warnings)
      if (one.number > last_) taken.push_back(one.warning), last_ = one.number;
    return taken;
  }
  /// Those, and what the last step goes on to warn of.
  std::vector<Warning> takeWithLast(const Snapshot& snapshot) {
    std::vector<Warning> taken = take(snapshot);
    for (const Warning& warning : snapshot.report.warnings) {
      const auto isSame = [&](const Warning& w) { return w.kind == warning.kind && w.text == warning.text; };
      if (std::none_of(taken.begin(), taken.end(), isSame)) taken.push_back(warning);
    }
    return taken;
  }

 private:
  std::uint64_t last_ = 0;
};

}  // namespace rbs

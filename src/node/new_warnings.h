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
  /// Those since the last call, as far as the snapshot has them, each text once, the oldest first.
  std::vector<Warning> take(const Snapshot& snapshot) {
    std::vector<Warning> taken;
    for (const NumberedWarning& one : *snapshot.warnings)
      if (one.number > last_) add(one.warning, taken), last_ = one.number;
    return taken;
  }
  /// Also the warnings of the last step that an earlier step gave first; 100 at most.
  std::vector<Warning> takeWithLast(const Snapshot& snapshot) {
    std::vector<Warning> taken = take(snapshot);
    for (const Warning& warning : snapshot.report.warnings)
      if (taken.size() < 100) add(warning, taken);
    return taken;
  }

 private:
  static void add(const Warning& warning, std::vector<Warning>& to) {
    if (std::find(to.begin(), to.end(), warning) == to.end()) to.push_back(warning);
  }

  std::uint64_t last_ = 0;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The last warnings of a simulator. Many steps may go by between two snapshots, and a trouble may last for one.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace rbs {

class WarningLog {
 public:
  /// Takes the warnings of a step. Those that the step before gave too are not new.
  void add(const std::vector<Warning>& given) {
    if (given.empty() && last_.empty()) return;
    const std::vector<Warning> now(given.begin(), given.begin() + std::min(kMost, given.size()));
    std::vector<NumberedWarning> all = *all_;
    for (const Warning& warning : now)
      if (std::find(last_.begin(), last_.end(), warning) == last_.end()) all.push_back({++count_, warning});
    last_ = now;
    if (all.size() == all_->size()) return;
    if (all.size() > kMost) all.erase(all.begin(), all.end() - kMost);
    all_ = std::make_shared<const std::vector<NumberedWarning>>(std::move(all));
  }
  /// Of another world, which has given none. The numbers go on.
  void clear() {
    last_.clear();
    all_ = std::make_shared<const std::vector<NumberedWarning>>();
  }
  /// Those since the last clear(), the oldest first, 100 at most; not null.
  std::shared_ptr<const std::vector<NumberedWarning>> all() const { return all_; }

 private:
  static constexpr std::size_t kMost = 100;

  std::vector<Warning> last_;  // of the last step
  std::uint64_t count_ = 0;    // of all worlds
  std::shared_ptr<const std::vector<NumberedWarning>> all_ =
      std::make_shared<const std::vector<NumberedWarning>>();
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Which bodies can be clicked, and the markers that catch the click.
#pragma once

#include <memory>
#include <set>
#include <vector>

#include "marker_board.h"
#include "rigid_body_sim/snapshot.h"

namespace rbs {

/// Every body that is not see-through is a click target in a world of up to 300. In a larger one those
/// nearest to `focus` are, since every target costs the server and RViz time in each cycle.
class ClickTargets {
 public:
  explicit ClickTargets(MarkerBoard& board) : board_(board) {}

  /// Brings the targets to where the bodies are. The last of `selection` is always among them.
  void update(const Snapshot& snapshot, const Vec3& focus, const std::vector<BodyId>& selection);

  /// Shows every look again in the next update, where it is not what it should be.
  void refresh() { described_.reset(); }

 private:
  void choose(const Snapshot& snapshot, const Vec3& focus, BodyId selected);

  MarkerBoard& board_;
  std::vector<int> chosen_;  ///< places in the snapshot
  std::set<std::string> names_;
  Vec3 focus_ = Vec3::Zero();
  std::vector<BodyId> selection_;
  std::chrono::steady_clock::time_point chosen_at_;
  std::shared_ptr<const std::vector<BodyDescription>> described_;
};

}  // namespace rbs

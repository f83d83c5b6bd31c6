// SPDX-License-Identifier: BSD-3-Clause
// Resume: saves the state of the simulation in a file at the end of a node, and restores it in the next one.
#pragma once

#include "session.h"

#include <string>

namespace rbs {

class Resume {
 public:
  /// File in which the node of this name saves its state: in $ROS_HOME, or else in ~/.ros.
  static std::string usualFile(const std::string& node_name);

  /// With `take`, replaces the scene by the state in `file`. Where the file is missing, damaged, or not
  /// written by a node, it logs the reason and the scene stays. Without `take`, it logs that there is a state
  /// and how to resume it. `file` empty: nothing is saved or restored.
  Resume(Session& session, const std::string& file, bool take);

  /// Writes the state, whole or not at all, where the world was edited or time has passed. An earlier state
  /// that was not taken is replaced only by an edited one, and is then saved as "*.previous.yaml". Waits for
  /// the step under way. Prints the result, because the log of ROS ends before the node. Never throws.
  void keep();

 private:
  void take();
  void offer() const;
  std::string previous() const;

  Session& session_;
  const std::string file_;
  bool untaken_ = false;  ///< whether the file holds a state that this node has not resumed
  std::uint64_t first_edits_, first_steps_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Resume: what the simulation has come to, kept in a file from the end of one node to the start of the next.
#pragma once

#include "session.h"

#include <string>

namespace rbs {

class Resume {
 public:
  /// Where the node of this name keeps its state: in $ROS_HOME, or else ~/.ros.
  static std::string usualFile(const std::string& node_name);

  /// With `take`, replaces the scene by the state in `file`; where there is none, or it is damaged or not one
  /// that a node has kept, logs the reason and the scene stays. Without, logs that there is one and how to
  /// take it. `file` empty: keeps and takes nothing.
  Resume(Session& session, const std::string& file, bool take);

  /// Writes the state, whole or not at all, where a person would miss it: the world was edited, or time has
  /// gone on. A state that was there and was not taken gives way only to one that was edited, and is then
  /// kept beside it, as
  /// "*.previous.yaml". Waits for the step that is being taken. Prints what it did, since the log of ROS ends
  /// before the node; never throws.
  void keep();

 private:
  void take();
  void offer() const;
  std::string previous() const;

  Session& session_;
  const std::string file_;
  bool untaken_ = false;  ///< whether there is a state that this node has not taken
  std::uint64_t first_edits_, first_steps_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The ghost: the reference run of the scene, drawn translucent beside the live bodies, so that error can be
// seen.
#pragma once

#include "markers.h"

#include "rigid_body_sim/simulator.h"

#include <ros/ros.h>

#include <memory>
#include <mutex>
#include <optional>

namespace rbs {

/// Publishes ~ghost. It begins with the live state when it is shown, and again with every edit; it keeps up
/// with the live time as well as it can. Thread-safe. Nobody waits for a step of it, which may take seconds;
/// only the destructor does, for two at most.
class Ghost {
 public:
  Ghost(ros::NodeHandle& node, Simulator& simulator);
  ~Ghost();

  /// Shows it, from the state as it is now; or takes it away.
  void show(bool on);
  /// Physics time that it is behind `now`, s, >= 0; empty where it is not shown.
  std::optional<double> lag(double now) const;

 private:
  struct Run;

  void follow(Run& run);
  void keepUp(Run& run);
  void hide();
  void publish(const Snapshot& snapshot);

  Simulator& simulator_;
  MarkerPublisher markers_;
  std::shared_ptr<const std::vector<BodyDescription>> described_,
      drawn_;                 ///< bodies as simulated, and as drawn
  std::mutex mutex_;          ///< one caller at a time shows or hides
  std::shared_ptr<Run> run_;  ///< the last one, by atomic_load and atomic_store; empty: none
};

}  // namespace rbs

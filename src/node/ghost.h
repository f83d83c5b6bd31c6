// SPDX-License-Identifier: BSD-3-Clause
// The ghost: the reference run of the scene, drawn translucent beside the live bodies, so that error can be seen.
#pragma once

#include "markers.h"

#include "rigid_body_sim/simulator.h"

#include <ros/ros.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

namespace rbs {

/// Publishes ~ghost. It begins with the live state when it is shown, and again with every edit; it keeps up with the
/// live time as well as it can. Thread-safe.
class Ghost {
 public:
  Ghost(ros::NodeHandle& node, Simulator& simulator);
  ~Ghost();

  /// Shows it, from the state as it is now; or takes it away.
  void show(bool on);
  /// Physics time that it is behind the live bodies, s, >= 0; empty where it is not shown.
  std::optional<double> lag() const;

 private:
  void run();
  void publish(const Snapshot& snapshot);

  Simulator& simulator_;
  MarkerPublisher markers_;
  std::shared_ptr<const std::vector<BodyDescription>> described_, drawn_;  ///< bodies as simulated, and as drawn
  std::mutex mutex_;  ///< of the thread's begin and end
  std::atomic<bool> stop_{false}, shown_{false};
  std::atomic<double> time_;  ///< physics time that it has come to, s
  std::thread thread_;
};

}  // namespace rbs

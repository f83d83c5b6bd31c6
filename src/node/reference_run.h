// SPDX-License-Identifier: BSD-3-Clause
// The reference run: a second, more accurate simulation of the scene, drawn as a translucent overlay, so that
// errors can be seen.
#pragma once

#include "markers.h"
#include "run_comparison.h"

#include "rigid_body_sim/simulator.h"

#include <ros/ros.h>

#include <memory>
#include <mutex>
#include <optional>

namespace rbs {

/// Steps a copy of the live world with reference settings and publishes it on ~ghost. The copy is taken when
/// the run is shown, and again after every edit. Thread-safe. A step may take seconds and falls behind the
/// live time then. Only the destructor waits for a step, for two seconds at most.
class ReferenceRun {
 public:
  ReferenceRun(ros::NodeHandle& node, Simulator& simulator);
  ~ReferenceRun();

  /// Shows the run, from the state as it is now, or hides it.
  void show(bool on);
  /// Physics time by which the run is behind `now`, s, >= 0; empty where it is not shown.
  std::optional<double> lag(double now) const;
  /// Hands the live bodies to the comparison with the run, where it is shown.
  void compareWith(const Snapshot& live);
  /// What that has come to; null: nothing yet, or the run is not shown.
  std::shared_ptr<const RunComparison::Distances> distances() const { return comparison_.newest(); }

 private:
  struct Run;

  void follow(Run& run);
  void keepUp(Run& run);
  void hide();
  void publish(const Snapshot& snapshot);

  Simulator& simulator_;
  MarkerPublisher markers_;
  std::shared_ptr<const std::vector<BodyDescription>> described_,
      drawn_;  ///< descriptions as simulated, and as drawn
  RunComparison comparison_;
  std::mutex mutex_;          ///< one caller at a time shows or hides
  std::shared_ptr<Run> run_;  ///< the present run, by atomic_load and atomic_store; null: none
};

}  // namespace rbs

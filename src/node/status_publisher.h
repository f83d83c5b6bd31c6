// SPDX-License-Identifier: BSD-3-Clause
// Publishes the state of the simulation: ~status, ~wind, /diagnostics and the line on the terminal.
#pragma once

#include "new_warnings.h"
#include "reference_run.h"
#include "timeline.h"
#include "topic.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/publisher.h>

namespace rbs {

class StatusPublisher {
 public:
  StatusPublisher(ros::NodeHandle& node, const Simulator& simulator, const ReferenceRun& reference_run);

  void publish(const Timeline::Moment& moment);
  /// Sends /diagnostics with the stamp of the moment, once in ~diagnostic_period of wall time however often it is called.
  void diagnose(const Timeline::Moment& moment);

 private:
  void describeSimulation(const Snapshot& snapshot, diagnostic_updater::DiagnosticStatusWrapper& status);

  const Simulator& simulator_;
  const ReferenceRun& reference_run_;
  Topic status_, wind_;
  ros::Publisher diagnostics_;
  ros::SteadyTime last_diagnosis_;
  NewWarnings new_warnings_, undiagnosed_;
};

/// One line about the simulation, for a terminal.
std::string statusLine(const Snapshot& snapshot, const Pace& pace);

}  // namespace rbs

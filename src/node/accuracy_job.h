// SPDX-License-Identifier: BSD-3-Clause
// The study of what accuracy costs for the running scene, in a process of its own at the lowest priority, so that the
// simulation does not stutter.
#pragma once

#include "timeline.h"

#include "rigid_body_sim/accuracy.h"
#include "rigid_body_sim/world.h"

#include <ros/ros.h>

#include <boost/process/child.hpp>

#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace rbs {

/// Publishes ~accuracy, latched. Thread-safe.
class AccuracyJob {
 public:
  AccuracyJob(ros::NodeHandle& node, Simulator& simulator, Timeline& timeline);
  ~AccuracyJob();

  /// Measures the scene as it is now, hands left out; ends the study before. Returns its number. Throws InvalidInput
  /// for faulty options, and std::runtime_error where the program that measures cannot be run.
  std::uint32_t start(const AccuracyOptions& options);
  /// Ends the study that is going on; what it knows stays. Returns whether there was one.
  bool stop();
  /// What the last study found; empty before there is anything.
  std::optional<AccuracyStudy> found() const;

 private:
  void follow(boost::process::ipstream& lines, std::uint32_t job);
  void publish(std::uint32_t job, double progress, bool done, const AccuracyStudy& study);
  void end();

  Simulator& simulator_;
  Timeline& timeline_;
  ros::Publisher publisher_;
  std::mutex running_;  ///< one caller at a time starts or stops
  std::string file_;    ///< the scene that is measured; empty: none
  std::optional<boost::process::child> process_;
  std::thread reader_;
  std::uint32_t jobs_ = 0;
  mutable std::mutex mutex_;  ///< of found_
  std::optional<AccuracyStudy> found_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The study of what accuracy costs for the running scene, in a process of its own at the lowest priority, so
// that the simulation does not stutter.
#pragma once

#include "child_process.h"
#include "timeline.h"

#include "rigid_body_sim/accuracy.h"
#include "rigid_body_sim/world.h"

#include <ros/ros.h>

#include <atomic>
#include <future>
#include <mutex>
#include <string>
#include <thread>

namespace rbs {

/// Publishes ~accuracy, latched; again when what was measured stops to hold for the scene, or holds again.
/// Thread-safe.
class AccuracyJob {
 public:
  AccuracyJob(ros::NodeHandle& node, Simulator& simulator, Timeline& timeline);
  ~AccuracyJob();

  /// Measures the scene as it is now, mouse constraints left out; ends the study before. Returns its number.
  /// Throws InvalidInput for faulty options, and std::runtime_error where the program that measures cannot be
  /// run.
  std::uint32_t start(const AccuracyOptions& options);
  /// Ends the study that is going on, within two seconds; what it knows stays. Returns whether there was one.
  bool stop();
  /// What the last finished study found. Throws std::runtime_error where there is none, where it has no
  /// errors, and where it was not measured on the scene of this snapshot.
  AccuracyStudy foundFor(const Snapshot& now) const;

 private:
  /// A study and the scene it was measured on.
  struct Known {
    std::uint32_t job = 0;  ///< 0: nothing was measured yet
    AccuracyStudy study;
    double progress = 0.0;
    bool done = false;
    std::shared_ptr<const Snapshot> scene;
    std::string stale;  ///< why it does not hold for the scene as it is now; empty: it does
  };

  void follow(std::vector<std::string> command, std::string scene, std::promise<void> started);
  AccuracyStudy read(ChildProcess& program);
  void update(double progress, bool done, const AccuracyStudy& study);
  void compare();
  void publish();
  void end();

  Simulator& simulator_;
  Timeline& timeline_;
  ros::Publisher publisher_;
  std::mutex running_;  ///< one caller at a time starts or stops
  std::thread reader_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;  ///< of known_
  Known known_;
  ros::WallTimer compare_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// ~commands: what changes the world, and checkpoints of all of it, for recordings. Nothing is recorded while
// nobody subscribes.
#pragma once

#include "timeline.h"

#include "rigid_body_sim/recording.h"

#include <ros/ros.h>

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace rbs {

/// The simulator's thread only appends to a list. A thread of its own writes the texts and publishes them.
class CommandPublisher {
 public:
  /// A checkpoint follows every `checkpoint_period` s of physics time.
  CommandPublisher(ros::NodeHandle& node, Simulator& simulator, const Timeline& timeline,
                   double checkpoint_period);
  ~CommandPublisher();

 private:
  void chooseWhetherToRecord(bool newcomer);
  void keep(Recorded entry);
  void loop();
  void publish(const Recorded& entry);

  Simulator& simulator_;
  const Timeline& timeline_;
  const double checkpoint_period_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Recorded> entries_;  ///< to be published, under the mutex
  bool stop_ = false;              ///< under the mutex

  std::mutex subscribing_;  ///< one subscriber comes or goes at a time
  bool recording_ = false;  ///< under it
  ros::Publisher publisher_;
  std::thread thread_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// All that the node publishes, each at its own rate, from one thread that lives on wall time: so pictures
// and /clock go on while the simulation is paused.
#pragma once

#include "event_publisher.h"
#include "ghost.h"
#include "interactive_bodies.h"
#include "markers.h"
#include "state_publisher.h"
#include "status_publisher.h"
#include "tf_publisher.h"
#include "timeline.h"

#include <ros/callback_queue.h>
#include <ros/spinner.h>

#include <string>
#include <vector>

namespace rbs {

class Publishers {
 public:
  struct Options {
    bool clock = true;        ///< send /clock
    bool status_line = false; ///< print a line a second to the terminal
    TfMode tf = TfMode::All;
    std::string tf_prefix;    ///< in front of the bodies' frames
  };

  Publishers(Simulator& simulator, Timeline& timeline, const Ghost& ghost, const Options& options);

 private:
  void every(double seconds, void (Publishers::*send)());
  void sendMotion();
  void sendMarkers();
  void sendInteractive();
  void sendStatus();
  void printStatus();

  Simulator& simulator_;
  Timeline& timeline_;
  const Options options_;
  ros::CallbackQueue queue_;  ///< of the timers alone, so that a long service call holds up nothing
  ros::NodeHandle node_;
  ros::Publisher clock_;
  TfPublisher tf_;
  StatePublisher states_;
  EventPublisher events_;
  StatusPublisher status_;
  MarkerPublisher markers_;
  InteractiveBodies interactive_;
  Timeline::Moment moment_;  ///< the last one
  std::vector<ros::WallTimer> timers_;
  ros::AsyncSpinner spinner_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Publishers of the node, each at its own rate, in threads that run on wall time. So pictures and /clock go
// on while the simulation is paused. User input waits for the simulator, so it has a thread of its own: a
// slow step delays no clock and no transform.
#pragma once

#include "detail_publisher.h"
#include "event_publisher.h"
#include "interactive_bodies.h"
#include "markers.h"
#include "reference_run.h"
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
    bool clock = true;         ///< send /clock
    bool status_line = false;  ///< print a line a second to the terminal
    TfMode tf = TfMode::All;
    std::string tf_prefix;        ///< prefix of the bodies' frames
    double contacts_rate = 10.0;  ///< most messages of ~contacts a second; 0: one with every ~body_states
    double repeat_period = 5.0;   ///< period after which descriptions and markers are sent again, s; 0: never
  };

  Publishers(Simulator& simulator, Timeline& timeline, ReferenceRun& reference_run, const Options& options);

 private:
  void every(double seconds, void (Publishers::*send)(), ros::CallbackQueue& queue);
  void sendMotion();
  void sendMarkers();
  void sendInteractive();
  void sendStatus();
  void printStatus();

  Simulator& simulator_;
  Timeline& timeline_;
  const Options options_;
  ros::CallbackQueue queue_,
      user_input_queue_;  ///< of the timers alone, so that a long service call delays none
  ros::NodeHandle node_;
  ros::Publisher clock_;
  TfPublisher tf_;
  StatePublisher states_;
  DetailPublisher details_;
  EventPublisher events_;
  StatusPublisher status_;
  MarkerPublisher markers_;
  InteractiveBodies interactive_;
  Timeline::Moment moment_;  ///< the last one
  std::vector<ros::WallTimer> timers_;
  ros::AsyncSpinner spinner_, user_input_spinner_;
};

}  // namespace rbs

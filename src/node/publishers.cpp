// SPDX-License-Identifier: BSD-3-Clause
#include "publishers.h"

#include <rosgraph_msgs/Clock.h>

#include <iostream>

namespace rbs {
namespace {

// A little more often than the 60 steps a second of most scenes, so that no step is missed.
constexpr double kMotionPeriod = 1.0 / 80.0;
constexpr double kMarkerPeriod = 1.0 / 30.0;
constexpr double kInteractivePeriod = 1.0 / 15.0;
constexpr double kStatusPeriod = 1.0 / 10.0;
constexpr double kLinePeriod = 1.0;

}  // namespace

Publishers::Publishers(Simulator& simulator, Timeline& timeline, ReferenceRun& reference_run,
                       const Options& options)
    : simulator_(simulator),
      timeline_(timeline),
      options_(options),
      node_("~"),
      tf_(node_, options.tf, options.tf_prefix),
      states_(node_, options.contacts_rate, options.repeat_period),
      details_(node_, reference_run),
      events_(node_),
      status_(node_, simulator, reference_run),
      markers_(node_, "visualization_marker_array", "bodies", options.tf, options.tf_prefix,
               options.repeat_period),
      interactive_(simulator),
      moment_(timeline.advance(simulator, true)),
      spinner_(1, &queue_),
      user_input_spinner_(1, &user_input_queue_) {
  if (options.clock) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  every(kMotionPeriod, &Publishers::sendMotion, queue_);
  every(kMarkerPeriod, &Publishers::sendMarkers, queue_);
  every(kInteractivePeriod, &Publishers::sendInteractive, user_input_queue_);
  every(kStatusPeriod, &Publishers::sendStatus, queue_);
  if (options.status_line) every(kLinePeriod, &Publishers::printStatus, queue_);
  spinner_.start();
  user_input_spinner_.start();
}

void Publishers::every(double seconds, void (Publishers::*send)(), ros::CallbackQueue& queue) {
  ros::WallTimerOptions timer(
      ros::WallDuration(seconds), [this, send](const ros::WallTimerEvent&) { (this->*send)(); }, &queue);
  timers_.push_back(node_.createWallTimer(timer));
}

// A newcomer to any of them needs all at one stamp: a state, and the transform to go with it.
void Publishers::sendMotion() {
  const bool of_tf = tf_.hasNewcomer();
  const bool newcomer = states_.hasNewcomer() || of_tf;
  moment_ = timeline_.advance(simulator_, newcomer);
  tf_.publish(moment_);
  states_.publish(moment_);
  details_.publish(moment_);
  events_.publish(moment_);
  if (!options_.clock) return;
  rosgraph_msgs::Clock now;
  now.clock = moment_.stamp;
  clock_.publish(now);
}

void Publishers::sendMarkers() {
  markers_.publish(*moment_.snapshot);
}

void Publishers::sendInteractive() {
  interactive_.update(*simulator_.snapshot());
}

void Publishers::sendStatus() {
  status_.publish(moment_);
  status_.diagnose(moment_);
}

void Publishers::printStatus() {
  std::cout << statusLine(*moment_.snapshot, simulator_.pace()) << std::endl;
}

}  // namespace rbs

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

Publishers::Publishers(Simulator& simulator, Timeline& timeline, const Ghost& ghost, const Options& options)
    : simulator_(simulator),
      timeline_(timeline),
      options_(options),
      node_("~"),
      tf_(node_, options.tf, options.tf_prefix),
      states_(node_),
      events_(node_),
      status_(node_, simulator, ghost),
      markers_(node_, "visualization_marker_array", "bodies", options.tf, options.tf_prefix),
      interactive_(simulator),
      moment_(timeline.advance(simulator, true)),
      spinner_(1, &queue_) {
  if (options.clock) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  every(kMotionPeriod, &Publishers::sendMotion);
  every(kMarkerPeriod, &Publishers::sendMarkers);
  every(kInteractivePeriod, &Publishers::sendInteractive);
  every(kStatusPeriod, &Publishers::sendStatus);
  if (options.status_line) every(kLinePeriod, &Publishers::printStatus);
  spinner_.start();
}

void Publishers::every(double seconds, void (Publishers::*send)()) {
  ros::WallTimerOptions timer(ros::WallDuration(seconds), [this, send](const ros::WallTimerEvent&) { (this->*send)(); },
                              &queue_);
  timers_.push_back(node_.createWallTimer(timer));
}

void Publishers::sendMotion() {
  const bool newcomer = tf_.hasNewcomer();
  moment_ = timeline_.advance(simulator_, newcomer);
  tf_.publish(moment_, newcomer);
  states_.publish(moment_);
  events_.publish(moment_);
  if (!options_.clock) return;
  rosgraph_msgs::Clock now;
  now.clock = moment_.stamp;
  clock_.publish(now);
}

void Publishers::sendMarkers() { markers_.publish(*moment_.snapshot); }

void Publishers::sendInteractive() { interactive_.update(*moment_.snapshot); }

void Publishers::sendStatus() {
  status_.publish(moment_);
  status_.diagnose(moment_);
}

void Publishers::printStatus() { std::cout << statusLine(*moment_.snapshot) << std::endl; }

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// ~cmd_twist and ~cmd_wrench: for controllers that would not call a service at every step. The frame_id
// of a message names the body, and its numbers are along the axes of that body as they are when it is taken,
// between two steps. A command that makes no sense is dropped with a warning.
#pragma once

#include "rigid_body_sim/simulator.h"

#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>

namespace rbs {

class CommandTopics {
 public:
  /// A body has one slot for ~cmd_wrench: a message replaces the one before, and acts until it is replaced,
  /// or for this long, s of simulation time: twice the period of a controller at 10 Hz. One that dies pushes
  /// no more. What comes in while the simulation is paused piles up nowhere. ~apply_wrench adds to it.
  static constexpr double kWrenchSeconds = 0.2;

  explicit CommandTopics(Simulator& simulator);

 private:
  void onTwist(const geometry_msgs::TwistStamped& command);
  void onWrench(const geometry_msgs::WrenchStamped& command);
  void send(const char* topic, std::function<void(World&)> command);

  Simulator& simulator_;
  ros::Subscriber twist_, wrench_;
};

}  // namespace rbs

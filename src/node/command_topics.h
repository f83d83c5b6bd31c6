// SPDX-License-Identifier: BSD-3-Clause
// ~cmd_twist and ~cmd_wrench: for controllers that would not call a service at every step. The frame_id
// of a message names the body, and its numbers are along the axes of that body.
#pragma once

#include "rigid_body_sim/simulator.h"

#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>

namespace rbs {

class CommandTopics {
 public:
  /// How long a wrench acts, s of simulation time: as long as a controller at 10 Hz needs.
  static constexpr double kWrenchSeconds = 0.1;

  explicit CommandTopics(Simulator& simulator);

 private:
  void onTwist(const geometry_msgs::TwistStamped& command);
  void onWrench(const geometry_msgs::WrenchStamped& command);
  void edit(const char* topic, const std::function<void(World&)>& command);

  Simulator& simulator_;
  ros::Subscriber twist_, wrench_;
};

}  // namespace rbs

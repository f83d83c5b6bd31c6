// SPDX-License-Identifier: BSD-3-Clause
// ViewerSelection: the bodies that a viewer of a replay selects, in place of those that were selected when it was
// recorded; and the answer to an attempt to move one.
#pragma once

#include "player.h"

#include <rigid_body_sim/BodyNames.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>

#include <string>
#include <vector>

namespace rbs {

class ViewerSelection {
 public:
  /// Listens under the name of the simulator. It publishes on the player's topics: a latched topic has the last
  /// message of each publisher.
  ViewerSelection(const Player& player, const std::string& simulator);

 private:
  void hearOne(const std_msgs::String& name);
  void hearMany(const rigid_body_sim::BodyNames& bodies) { publish(bodies.names); }
  void hearMouse(const visualization_msgs::InteractiveMarkerFeedback& feedback);
  void publish(const std::vector<std::string>& names);

  ros::NodeHandle node_;
  ros::Publisher selected_bodies_, selection_, answer_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace rbs

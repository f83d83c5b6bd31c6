// SPDX-License-Identifier: BSD-3-Clause
// The bodies of one simulator, as its descriptions tell them, and the way by which a mouse reaches them.
#pragma once

#include <rigid_body_sim/BodyDescriptions.h>
#include <ros/ros.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rbs {

/// Lives on the GUI thread, where RViz also handles the messages of subscribers.
class SimulatorBodies {
 public:
  /// `node`: the resolved name of the simulator's node.
  explicit SimulatorBodies(const std::string& node);

  /// The body whose id has these lower 31 bits; null for an unknown one, or while no description has come.
  const rigid_body_sim::BodyDescription* find(std::uint64_t low_id) const;
  /// The frame of the world.
  const std::string& frame() const { return descriptions_.header.frame_id; }

  /// Whether the node takes what send() sends. Not, for instance, while a bag is played without it.
  bool listens() const { return publisher_.getNumSubscribers() > 0; }
  /// Sends what a mouse does to a body. What comes before the node listens is kept until it does.
  void send(const visualization_msgs::InteractiveMarkerFeedback& feedback);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  ros::NodeHandle ros_;
  rigid_body_sim::BodyDescriptions descriptions_;
  std::vector<Feedback> unheard_;
  ros::Subscriber subscriber_;
  ros::Publisher publisher_;
};

}  // namespace rbs

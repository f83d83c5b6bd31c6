// SPDX-License-Identifier: BSD-3-Clause
// Frames that other nodes publish in tf: sensors, robots, maps.
#pragma once

#include "rigid_body_sim/types.h"

#include <ros/ros.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <string>

namespace rbs {

/// Listens to /tf and /tf_static, and remembers what others say. What this node publishes is not heard: it
/// knows better.
class TfFrames {
 public:
  explicit TfFrames(ros::NodeHandle& node);

  /// Where a frame is in worldFrame() by the newest transforms; never waits. Throws InvalidInput with the
  /// reason.
  Pose find(const std::string& frame_id) const;

 private:
  void hear(const ros::MessageEvent<const tf2_msgs::TFMessage>& event, bool is_static);

  tf2::BufferCore buffer_;
  ros::Subscriber moving_, still_;
};

}  // namespace rbs

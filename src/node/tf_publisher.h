// SPDX-License-Identifier: BSD-3-Clause
// Transforms: the bodies that can move, under "world", in one message and only where something moved.
#pragma once

#include "timeline.h"
#include "topic.h"

#include <map>
#include <string>

namespace rbs {

enum class TfMode { All, None };

class TfPublisher {
 public:
  /// A listener spends 20 ms on a message of 10,000 transforms but 0.1 ms on one of 300. Where more bodies
  /// than this can move, the first ones go out.
  static constexpr std::size_t kMostBodies = 300;

  /// The frame of a body is `prefix` and its name.
  TfPublisher(ros::NodeHandle& node, TfMode mode, const std::string& prefix);

  /// Whether somebody new listens, who needs all transforms at a stamp of their own.
  bool hasNewcomer();

  /// Sends the transforms that are not as they were sent last; all of them with `everything`, and once a
  /// second while time goes on.
  void publish(const Timeline::Moment& moment, bool everything);

 private:
  bool isDue(const BodyState& state, bool everything);

  const TfMode mode_;
  const std::string prefix_;
  Topic topic_;
  std::map<BodyId, Pose> sent_;
  ros::WallTime everything_sent_;
};

}  // namespace rbs

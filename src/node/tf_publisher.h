// SPDX-License-Identifier: BSD-3-Clause
// Transforms: the bodies that can move, under "world", all of them in one message for every stamp that a
// message of the node can have. So a lookup at the stamp of a message succeeds, for a body at rest too: tf2
// does not look ahead of the last transform of a frame.
#pragma once

#include "timeline.h"
#include "topic.h"

#include <string>

namespace rbs {

enum class TfMode { All, None };

class TfPublisher {
 public:
  /// A listener spends 20 ms on a message of 10,000 transforms but 0.1 ms on one of 300, which has 30 kB.
  /// Where more bodies than this can move, the first ones go out.
  static constexpr std::size_t kMostBodies = 300;

  /// The frame of a body is `prefix` and its name.
  TfPublisher(ros::NodeHandle& node, TfMode mode, const std::string& prefix);

  /// Whether somebody new listens, who needs all transforms at a stamp of their own.
  bool hasNewcomer();

  /// Sends the transforms of a moment with a new stamp.
  void publish(const Timeline::Moment& moment);

 private:
  const TfMode mode_;
  const std::string prefix_;
  Topic topic_;
};

}  // namespace rbs

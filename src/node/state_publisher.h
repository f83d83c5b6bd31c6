// SPDX-License-Identifier: BSD-3-Clause
// Topics that follow the bodies: descriptions, states and contacts.
#pragma once

#include "timeline.h"
#include "topic.h"

namespace rbs {

class StatePublisher {
 public:
  explicit StatePublisher(ros::NodeHandle& node);
  void publish(const Timeline::Moment& moment);

 private:
  void publishDescriptions(const Timeline::Moment& moment);
  void publishStates(const Timeline::Moment& moment);
  void publishContacts(const Timeline::Moment& moment);

  ros::Publisher descriptions_;  ///< latched
  Topic states_, contacts_;
  std::shared_ptr<const std::vector<BodyDescription>> described_;  ///< what was sent last
};

}  // namespace rbs

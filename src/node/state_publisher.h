// SPDX-License-Identifier: BSD-3-Clause
// Topics that follow the bodies: descriptions, states and contacts.
#pragma once

#include "timeline.h"
#include "topic.h"

namespace rbs {

class StatePublisher {
 public:
  /// Contacts go out at most `contacts_rate` times a second (0: with every state), the last ones always;
  /// descriptions again every `repeat_period` s of wall time (0: never), for bags that are played from the
  /// middle.
  StatePublisher(ros::NodeHandle& node, double contacts_rate, double repeat_period);

  /// Whether somebody new listens, who needs all at a stamp of its own.
  bool hasNewcomer();
  void publish(const Timeline::Moment& moment);

 private:
  void publishDescriptions(const Timeline::Moment& moment);
  void publishStates(const Timeline::Moment& moment);
  void publishContacts(const Timeline::Moment& moment);

  const ros::WallDuration contacts_period_, repeat_period_;
  ros::Publisher descriptions_;  ///< latched
  Topic states_, contacts_;
  bool contacts_due_ = false;  ///< they have changed since they were sent
  ros::WallTime contacts_sent_, descriptions_sent_;
  std::shared_ptr<const std::vector<BodyDescription>> described_;  ///< what was sent last
};

}  // namespace rbs

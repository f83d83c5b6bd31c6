// SPDX-License-Identifier: BSD-3-Clause
// Events: what happened to the world, found by comparing each snapshot with the one before. So it does not
// matter whether a service, a marker or a topic did it.
#pragma once

#include "new_warnings.h"
#include "timeline.h"
#include "topic.h"

namespace rbs {

class EventPublisher {
 public:
  explicit EventPublisher(ros::NodeHandle& node);
  void publish(const Timeline::Moment& moment);

 private:
  void compareBodies(const Snapshot& before, const Snapshot& now);
  void compareSurroundings(const Snapshot& before, const Snapshot& now);
  void compareRun(const Snapshot& before, const Snapshot& now);
  void send(const std::string& kind, const std::string& body, const std::string& text);

  ros::Publisher publisher_;
  ros::Time stamp_;
  std::shared_ptr<const Snapshot> last_;
  NewWarnings new_warnings_;
};

}  // namespace rbs

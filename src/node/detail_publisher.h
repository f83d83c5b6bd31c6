// SPDX-License-Identifier: BSD-3-Clause
// Topic ~body_details: how the last step took each body, and how far it is from the reference run.
#pragma once

#include "reference_run.h"
#include "timeline.h"
#include "topic.h"

namespace rbs {

/// While nobody listens nothing is worked out, and the runs are not compared.
class DetailPublisher {
 public:
  DetailPublisher(ros::NodeHandle& node, ReferenceRun& reference_run);

  void publish(const Timeline::Moment& moment);

 private:
  ReferenceRun& reference_run_;
  Topic topic_;
  bool due_ = false;  ///< something has changed since it was sent
  ros::WallTime sent_;
  std::shared_ptr<const RunComparison::Distances> sent_distances_;
};

}  // namespace rbs

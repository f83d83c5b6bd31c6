// SPDX-License-Identifier: BSD-3-Clause
#include "tf_publisher.h"

#include "convert.h"

#include <tf2_msgs/TFMessage.h>

namespace rbs {
TfPublisher::TfPublisher(ros::NodeHandle& node, TfMode mode, const std::string& prefix)
    : mode_(mode), prefix_(prefix), topic_(Topic::of<tf2_msgs::TFMessage>(node, "/tf", 100)) {}

bool TfPublisher::hasNewcomer() {
  return mode_ == TfMode::All && topic_.hasNewcomer();
}

void TfPublisher::publish(const Timeline::Moment& moment) {
  if (mode_ == TfMode::None || !moment.changed) return;
  const Snapshot& snapshot = *moment.snapshot;
  tf2_msgs::TFMessage message;
  std::size_t movable = 0;
  for (std::size_t i = 0; i < snapshot.states.size() && movable < kMostBodies; ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    if (body.kind == BodyKind::Static) continue;
    ++movable;
    if (!isFinite(snapshot.states[i].pose)) continue;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = moment.stamp;
    transform.header.frame_id = worldFrame();
    transform.child_frame_id = prefix_ + body.name;
    transform.transform = toTransform(snapshot.states[i].pose);
    message.transforms.push_back(transform);
  }
  if (!message.transforms.empty()) topic_.send(message);
}

}  // namespace rbs

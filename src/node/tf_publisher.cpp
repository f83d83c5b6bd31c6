// SPDX-License-Identifier: BSD-3-Clause
#include "tf_publisher.h"

#include "convert.h"

#include <tf2_msgs/TFMessage.h>

namespace rbs {
namespace {

bool same(const Pose& a, const Pose& b) {
  return a.p_WB == b.p_WB && a.q_WB.coeffs() == b.q_WB.coeffs();
}

bool isFinite(const Pose& pose) { return pose.p_WB.allFinite() && pose.q_WB.coeffs().allFinite(); }

}  // namespace

TfPublisher::TfPublisher(ros::NodeHandle& node, TfMode mode, const std::string& prefix)
    : mode_(mode), prefix_(prefix), topic_(Topic::of<tf2_msgs::TFMessage>(node, "/tf", 100)) {}

bool TfPublisher::hasNewcomer() { return mode_ == TfMode::All && topic_.hasNewcomer(); }

void TfPublisher::publish(const Timeline::Moment& moment, bool everything) {
  if (mode_ == TfMode::None || !moment.changed) return;
  const ros::WallTime now = ros::WallTime::now();
  everything = everything || now - everything_sent_ >= ros::WallDuration(1.0);
  if (everything) {
    everything_sent_ = now;
    sent_.clear();
  }
  const Snapshot& snapshot = *moment.snapshot;
  tf2_msgs::TFMessage message;
  std::size_t movable = 0;
  for (std::size_t i = 0; i < snapshot.states.size() && movable < kMostBodies; ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    if (body.kind == BodyKind::Static) continue;
    ++movable;
    if (!isDue(snapshot.states[i], everything)) continue;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = moment.stamp;
    transform.header.frame_id = worldFrame();
    transform.child_frame_id = prefix_ + body.name;
    transform.transform = toTransform(snapshot.states[i].pose);
    message.transforms.push_back(transform);
  }
  if (!message.transforms.empty()) topic_.send(message);
}

bool TfPublisher::isDue(const BodyState& state, bool everything) {
  if (!isFinite(state.pose)) return false;
  const auto [sent, is_new] = sent_.emplace(state.id, state.pose);
  if (is_new || everything) return true;
  if (same(sent->second, state.pose)) return false;
  sent->second = state.pose;
  return true;
}

}  // namespace rbs

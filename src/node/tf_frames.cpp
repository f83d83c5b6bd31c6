// SPDX-License-Identifier: BSD-3-Clause
#include "tf_frames.h"

#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/scene.h"

#include <tf2/exceptions.h>

#include <tuple>

namespace rbs {

TfFrames::TfFrames(ros::NodeHandle& node) {
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  const auto listen = [&](const char* topic, bool is_static) {
    const boost::function<void(const Event&)> keep = [this, is_static](const Event& event) {
      hear(event, is_static);
    };
    ros::SubscribeOptions options;
    options.initByFullCallbackType<const Event&>(topic, 100, keep);
    return node.subscribe(options);
  };
  moving_ = listen("/tf", false);
  still_ = listen("/tf_static", true);
}

void TfFrames::hear(const ros::MessageEvent<const tf2_msgs::TFMessage>& event, bool is_static) {
  const std::string& author = event.getPublisherName();
  if (author == ros::this_node::getName()) return;
  for (const geometry_msgs::TransformStamped& transform : event.getMessage()->transforms) {
    try {
      buffer_.setTransform(transform, author, is_static);
    } catch (const tf2::TransformException& error) {
      ROS_WARN_THROTTLE(10.0, "tf of %s: %s", author.c_str(), error.what());
    }
  }
}

Pose TfFrames::find(const std::string& frame_id) const {
  try {
    const geometry_msgs::Transform X =
        buffer_.lookupTransform(worldFrame(), frame_id, ros::Time(0)).transform;
    const auto& [p, q] = std::tie(X.translation, X.rotation);
    return {Vec3(p.x, p.y, p.z), Quat(q.w, q.x, q.y, q.z).normalized()};
  } catch (const tf2::TransformException& error) {
    const std::string world = "'" + worldFrame() + "'";
    // tf would complain of the world, of which it knows nothing until another node connects a frame with it.
    const std::string why = !buffer_._frameExists(frame_id) ? "tf knows no frame of this name"
                            : !buffer_._frameExists(worldFrame())
                                ? "nothing on tf connects it with " + world
                                : "tf says: " + printable(error.what(), kLongestPath);
    throw InvalidInput(
        {{"frame_id", quoted(frame_id),
          world + ", the name of a body, or a frame that tf connects with " + world + "; " + why}});
  }
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The bodies of one simulator by its descriptions, and the topics by which a mouse acts on them.
#pragma once

#include "../node/menu_titles.h"

#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyNames.h>
#include <rigid_body_sim/BodyState.h>
#include <ros/ros.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>

#include <QObject>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rbs {

/// Whether it only fences others in and is drawn translucent, like the walls of a box: a click is meant for
/// what one sees through it.
bool isSeeThrough(const rigid_body_sim::BodyDescription& body);

/// Lives on the GUI thread, where RViz also handles the messages of subscribers.
class SimulatorBodies {
 public:
  /// `node`: the resolved name of the simulator's node.
  explicit SimulatorBodies(const std::string& node);

  /// The body whose id has these lower 31 bits; null for an unknown one, or while no description has come.
  const rigid_body_sim::BodyDescription* find(std::uint64_t low_id) const;
  /// Of the menu of this body: all that are selected, where it is one of them.
  MenuScope menuScope(const std::string& body) const;
  /// What a ray meets: the body as it is now, and the point of its surface, in frame().
  struct Met {
    rigid_body_sim::BodyState body;
    geometry_msgs::Point point;
  };
  /// What a simulator says of a ray.
  struct Answer {
    bool came = false;  ///< false: it has not answered in time
    std::optional<Met> met;
  };
  using WithAnswer = std::function<void(const Answer&)>;
  /// Asks for the first body on a ray in frame() that hides what lies behind it and can be dragged, and returns at once. The event
  /// loop calls `then` when the simulator answers, and after 0.2 s without an answer. Nothing is called once this is gone.
  void meet(const geometry_msgs::Point& origin, const geometry_msgs::Vector3& direction, WithAnswer then);

  /// The frame of the world.
  const std::string& frame() const { return descriptions_.header.frame_id; }

  /// Whether the node takes what send() sends. Not, for instance, while a bag is played without it.
  bool listens() const { return publisher_.getNumSubscribers() > 0; }
  /// Sends what a mouse does to a body. What comes before the node listens is kept for a second.
  void send(const visualization_msgs::InteractiveMarkerFeedback& feedback);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  const std::string node_;
  ros::NodeHandle ros_;
  rigid_body_sim::BodyDescriptions descriptions_;
  rigid_body_sim::BodyNames selection_;
  std::vector<std::pair<ros::WallTime, Feedback>> unheard_;
  QObject answers_;  // the timers that wait for answers of the simulator are its children
  ros::Subscriber descriptions_topic_, selection_topic_;
  ros::Publisher publisher_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Markers: the bodies as RViz's MarkerArray display draws them.
//
// A message that moves a marker must carry its whole mesh again. So the mesh of a body that tf follows is
// sent once, locked to the frame of the body. What tf does not follow stands in the world frame and is
// sent again when it has moved: static bodies, which hardly ever do, and those of scenes too large for tf.
// Since RViz builds a locked mesh anew in every frame, only so many moving bodies are meshes; the others
// are its own spheres and cubes.
#pragma once

#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "marker_look.h"
#include "tf_publisher.h"

namespace rbs {

/// Publishes the bodies of snapshots on a topic. A new subscriber gets every body once; later messages hold
/// what changed since, and a few of the others in turn: a bag that is played from the middle soon shows all.
/// Thread-safe.
class MarkerPublisher {
 public:
  /// Bodies are in the namespace `group` of the node ("/sim/bodies"), so that those of several nodes stay
  /// apart. `tf` and `tf_prefix` as of the TfPublisher: which bodies have a frame, and its name. Every body
  /// is sent again once in `repeat_period` s of wall time; 0: never.
  MarkerPublisher(ros::NodeHandle& private_node, const std::string& topic, const std::string& group,
                  TfMode tf, const std::string& tf_prefix, double repeat_period);

  /// Sends what changed: new looks at once, and up to 333 bodies that moved, in turn where they are more: so
  /// the picture of a large scene moves in every part, but in no part as often. To be called 30 times a
  /// second.
  void publish(const Snapshot& snapshot);

 private:
  /// A body as the subscribers know it.
  struct Shown {
    BodyId id;
    MarkerLook look;
    Pose pose;
    std::vector<visualization_msgs::Marker> markers;
    bool due = true;  ///< to be sent with the next message
  };

  void greet(const ros::SingleSubscriberPublisher& newcomer);
  std::vector<MarkerLook> looksOf(const Snapshot& snapshot) const;
  void follow(const Snapshot& snapshot, visualization_msgs::MarkerArray& removals);
  void flood(const Snapshot& snapshot, visualization_msgs::MarkerArray& removals,
             visualization_msgs::MarkerArray& news);
  void move(const Snapshot& snapshot);
  void repeat();
  void collect(visualization_msgs::MarkerArray& news);

  const std::string bodies_ns_, fluid_ns_;
  const TfMode tf_;
  const std::string tf_prefix_;
  const double repeat_period_;
  std::mutex mutex_;
  bool begun_ = false;        ///< somebody has subscribed: shown_ is to be kept up
  std::vector<Shown> shown_;  ///< in the order of described_
  std::size_t moved_ = 0;     ///< the last one looked at for a move
  ros::WallTime repeated_;    ///< when the last bodies were sent again
  bool water_due_ = false;    ///< it is to be sent again
  double repeats_ = 0.0;      ///< share of a body that is to be sent again, carried over
  std::size_t next_ = 0;      ///< the next one to be sent again
  std::optional<visualization_msgs::Marker> water_;                ///< as the subscribers know it
  std::shared_ptr<const std::vector<BodyDescription>> described_;  ///< what shown_ shows
  ros::Publisher publisher_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Outlets: the topics on which a recording is published again, each message with a new stamp.
#pragma once

#include <rigid_body_sim/Status.h>
#include <ros/ros.h>
#include <rosbag/message_instance.h>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rbs {

/// Turns the stamp of a recorded message into that of the replay.
using Restamp = std::function<ros::Time(const ros::Time& stamp)>;

/// One topic.
class Outlet {
 public:
  /// What a message of the topic says.
  enum class Says {
    All,     ///< all there is at its time: one replaces the one before
    Change,  ///< what has changed since the one before: markers
    Event    ///< what has happened just then: it says nothing of a later time
  };

  virtual ~Outlet() = default;
  /// Publishes a recorded message.
  virtual void send(const rosbag::MessageInstance& message, const Restamp& restamp) = 0;
  /// Of a topic of changes: takes away all that is shown.
  virtual void clear() {}
  /// Of a topic of changes: sends only these of the markers of a message.
  virtual void sendPart(const rosbag::MessageInstance&, const std::vector<std::size_t>&, const Restamp&) {}

  Says says() const { return says_; }
  /// Whether to read a message at all: somebody listens, or may later.
  bool wanted() const { return is_latched_ || publisher_.getNumSubscribers() > 0; }
  /// The topic itself, for what a viewer adds to it.
  const ros::Publisher& publisher() const { return publisher_; }
  /// Whether somebody has subscribed since the last call.
  bool hasNewcomer() { return newcomer_->exchange(false); }

 protected:
  Outlet(Says says, bool is_latched) : says_(says), is_latched_(is_latched) {}

  const Says says_;
  const bool is_latched_;
  ros::Publisher publisher_;
  std::shared_ptr<std::atomic<bool>> newcomer_ = std::make_shared<std::atomic<bool>>(false);
};

/// The outlets of a simulator by topic: "body_states", "/tf". The status is not among them: the pace in it is that
/// of the replay.
std::map<std::string, std::unique_ptr<Outlet>> makeOutlets(ros::NodeHandle& simulator);

}  // namespace rbs

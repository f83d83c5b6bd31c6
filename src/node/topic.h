// SPDX-License-Identifier: BSD-3-Clause
// Topic: a publisher that sends only where someone listens, and everything once to someone new.
#pragma once

#include <ros/ros.h>

#include <atomic>
#include <memory>
#include <string>

namespace rbs {

class Topic {
 public:
  template <class Message>
  static Topic of(ros::NodeHandle& node, const std::string& name, std::uint32_t queue) {
    const auto newcomer = std::make_shared<std::atomic<bool>>(false);
    const ros::SubscriberStatusCallback connected = [newcomer](const ros::SingleSubscriberPublisher&) {
      *newcomer = true;
    };
    return Topic(node.advertise<Message>(name, queue, connected), newcomer);
  }

  /// Whether somebody has subscribed since the last call.
  bool hasNewcomer() { return newcomer_->exchange(false); }

  /// Whether somebody listens.
  bool isHeard() const { return publisher_.getNumSubscribers() > 0; }

  /// Whether to send now: somebody listens, and there is something new for him.
  bool wanted(bool changed) { return hasNewcomer() || (changed && isHeard()); }

  template <class Message>
  void send(const Message& message) {
    publisher_.publish(message);
  }

 private:
  Topic(ros::Publisher publisher, std::shared_ptr<std::atomic<bool>> newcomer)
      : publisher_(std::move(publisher)), newcomer_(std::move(newcomer)) {}

  ros::Publisher publisher_;
  std::shared_ptr<std::atomic<bool>> newcomer_;  ///< set by the threads of ROS
};

}  // namespace rbs

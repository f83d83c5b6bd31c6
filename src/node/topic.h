// SPDX-License-Identifier: BSD-3-Clause
// Topic: a publisher that sends only where someone listens, and everything once to someone new.
#pragma once

#include <ros/ros.h>

#include <string>

namespace rbs {

class Topic {
 public:
  template <class Message>
  static Topic of(ros::NodeHandle& node, const std::string& name, std::uint32_t queue) {
    return Topic(node.advertise<Message>(name, queue));
  }

  /// Whether somebody has subscribed since the last call.
  bool hasNewcomer() {
    const std::uint32_t before = subscribers_;
    subscribers_ = publisher_.getNumSubscribers();
    return subscribers_ > before;
  }

  /// Whether to send now: somebody listens, and there is something new for him.
  bool wanted(bool changed) { return hasNewcomer() || (changed && subscribers_ > 0); }

  template <class Message>
  void send(const Message& message) {
    publisher_.publish(message);
  }

 private:
  explicit Topic(ros::Publisher publisher) : publisher_(std::move(publisher)) {}

  ros::Publisher publisher_;
  std::uint32_t subscribers_ = 0;
};

}  // namespace rbs

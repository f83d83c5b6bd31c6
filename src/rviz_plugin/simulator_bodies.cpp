// SPDX-License-Identifier: BSD-3-Clause
#include "simulator_bodies.h"

#include <algorithm>

namespace rbs {

SimulatorBodies::SimulatorBodies(const std::string& node) {
  constexpr int kQueue = 100;
  const boost::function<void(const rigid_body_sim::BodyDescriptionsConstPtr&)> keep =
      [this](const rigid_body_sim::BodyDescriptionsConstPtr& message) { descriptions_ = *message; };
  subscriber_ = ros_.subscribe<rigid_body_sim::BodyDescriptions>(node + "/body_descriptions", 1, keep);
  publisher_ = ros_.advertise<Feedback>(node + "/interactive_bodies/mouse", kQueue,
                                        [this](const ros::SingleSubscriberPublisher& newcomer) {
                                          for (const Feedback& feedback : unheard_) newcomer.publish(feedback);
                                          unheard_.clear();
                                        });
}

const rigid_body_sim::BodyDescription* SimulatorBodies::find(std::uint64_t low_id) const {
  constexpr std::uint64_t kLow = 0x7fffffff;
  const auto& bodies = descriptions_.bodies;
  const auto it =
      std::find_if(bodies.begin(), bodies.end(), [&](const auto& body) { return (body.id & kLow) == low_id; });
  return it == bodies.end() ? nullptr : &*it;
}

void SimulatorBodies::send(const Feedback& feedback) {
  if (listens() && unheard_.empty()) return publisher_.publish(feedback);
  if (feedback.event_type == Feedback::MOUSE_DOWN) unheard_.clear();  // nobody waits for an earlier drag
  unheard_.push_back(feedback);
}

}  // namespace rbs

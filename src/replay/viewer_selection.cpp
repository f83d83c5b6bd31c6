// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_selection.h"

namespace rbs {

ViewerSelection::ViewerSelection(const Player& player, const std::string& simulator)
    : node_(simulator),
      selected_bodies_(player.publisherOf("selected_bodies")),
      selection_(player.publisherOf("selection")) {
  constexpr std::uint32_t kQueue = 100;
  answer_ = node_.advertise<std_msgs::String>("interactive_bodies/answer", kQueue);
  subscribers_ = {node_.subscribe("select", kQueue, &ViewerSelection::hearOne, this),
                  node_.subscribe("select_bodies", kQueue, &ViewerSelection::hearMany, this),
                  node_.subscribe("interactive_bodies/mouse", kQueue, &ViewerSelection::hearMouse, this)};
}

void ViewerSelection::hearOne(const std_msgs::String& name) {
  publish(name.data.empty() ? std::vector<std::string>() : std::vector<std::string>{name.data});
}

void ViewerSelection::hearMouse(const visualization_msgs::InteractiveMarkerFeedback& feedback) {
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  if (feedback.event_type == Feedback::MOUSE_DOWN) publish({feedback.marker_name});
  if (feedback.event_type != Feedback::POSE_UPDATE && feedback.event_type != Feedback::MENU_SELECT) return;
  std_msgs::String answer;
  answer.data =
      "This is the replay of a recording, in which nothing can be moved. Start a simulator for that.";
  answer_.publish(answer);
}

void ViewerSelection::publish(const std::vector<std::string>& names) {
  rigid_body_sim::BodyNames bodies;
  bodies.names = names;
  selected_bodies_.publish(bodies);
  std_msgs::String last;
  if (!names.empty()) last.data = names.back();
  selection_.publish(last);
}

}  // namespace rbs

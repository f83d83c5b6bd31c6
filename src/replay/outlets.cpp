// SPDX-License-Identifier: BSD-3-Clause
#include "outlets.h"

#include <rigid_body_sim/AccuracyStudy.h>
#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyDetails.h>
#include <rigid_body_sim/BodyNames.h>
#include <rigid_body_sim/BodyStates.h>
#include <rigid_body_sim/Contacts.h>
#include <rigid_body_sim/Event.h>
#include <rigid_body_sim/Wind.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

namespace rbs {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr std::uint32_t kQueue = 1000;

template <class Message>
void restampAll(Message& message, const Restamp& restamp) {
  if constexpr (ros::message_traits::HasHeader<Message>::value)
    message.header.stamp = restamp(message.header.stamp);
}
void restampAll(tf2_msgs::TFMessage& message, const Restamp& restamp) {
  for (geometry_msgs::TransformStamped& transform : message.transforms) restampAll(transform, restamp);
}
// A marker without a stamp follows its frame.
void restampAll(Marker& marker, const Restamp& restamp) {
  if (!marker.header.stamp.isZero()) marker.header.stamp = restamp(marker.header.stamp);
}
void restampAll(MarkerArray& message, const Restamp& restamp) {
  for (Marker& marker : message.markers) restampAll(marker, restamp);
}

template <class Message>
class OutletOf : public Outlet {
 public:
  OutletOf(ros::NodeHandle& node, const std::string& topic, Says says, bool is_latched = false)
      : Outlet(says, is_latched) {
    const ros::SubscriberStatusCallback connected =
        [newcomer = newcomer_](const ros::SingleSubscriberPublisher&) { *newcomer = true; };
    publisher_ = node.advertise<Message>(topic, kQueue, connected, {}, {}, is_latched);
  }

  void send(const rosbag::MessageInstance& instance, const Restamp& restamp) override {
    const boost::shared_ptr<Message> message = instance.instantiate<Message>();
    if (!message) return;  // of another type than the simulator's
    restampAll(*message, restamp);
    publisher_.publish(message);
  }
};

std::vector<Marker> markersOf(const MarkerArray& message) {
  return message.markers;
}
std::vector<Marker> markersOf(const Marker& message) {
  return {message};
}

/// Markers in messages of either type.
template <class Message>
class MarkerOutlet : public OutletOf<Message> {
 public:
  MarkerOutlet(ros::NodeHandle& node, const std::string& topic)
      : OutletOf<Message>(node, topic, Outlet::Says::Change) {}

  void clear() override {
    Marker all;
    all.action = Marker::DELETEALL;
    publish({all});
  }

  void sendPart(const rosbag::MessageInstance& instance, const std::vector<std::size_t>& places,
                const Restamp& restamp) override {
    const boost::shared_ptr<Message> message = instance.instantiate<Message>();
    if (!message) return;
    restampAll(*message, restamp);
    const std::vector<Marker> markers = markersOf(*message);
    std::vector<Marker> chosen;
    for (const std::size_t place : places) chosen.push_back(markers.at(place));
    publish(chosen);
  }

 private:
  void publish(const std::vector<Marker>& markers) {
    if constexpr (std::is_same_v<Message, Marker>) {
      for (const Marker& marker : markers) this->publisher_.publish(marker);
    } else {
      MarkerArray message;
      message.markers = markers;
      this->publisher_.publish(message);
    }
  }
};

}  // namespace

std::map<std::string, std::unique_ptr<Outlet>> makeOutlets(ros::NodeHandle& simulator) {
  using namespace rigid_body_sim;
  using Says = Outlet::Says;
  constexpr bool kLatched = true;
  std::map<std::string, std::unique_ptr<Outlet>> outlets;
  const auto add = [&](auto type, const std::string& topic, Says says, bool is_latched = false) {
    outlets[topic] = std::make_unique<OutletOf<decltype(type)>>(simulator, topic, says, is_latched);
  };
  add(BodyDescriptions(), "body_descriptions", Says::All, kLatched);
  add(BodyStates(), "body_states", Says::All);
  add(BodyDetails(), "body_details", Says::All);
  add(Contacts(), "contacts", Says::All);
  add(Wind(), "wind", Says::All);
  add(AccuracyStudy(), "accuracy", Says::All, kLatched);
  add(Event(), "events", Says::Event);
  add(BodyNames(), "selected_bodies", Says::Event, kLatched);
  add(std_msgs::String(), "selection", Says::Event, kLatched);
  add(tf2_msgs::TFMessage(), "/tf", Says::All);
  add(tf2_msgs::TFMessage(), "/tf_static", Says::All, kLatched);
  outlets["visualization_marker_array"] =
      std::make_unique<MarkerOutlet<MarkerArray>>(simulator, "visualization_marker_array");
  outlets["ghost"] = std::make_unique<MarkerOutlet<MarkerArray>>(simulator, "ghost");
  outlets["interactive_bodies/springs"] =
      std::make_unique<MarkerOutlet<Marker>>(simulator, "interactive_bodies/springs");
  return outlets;
}

}  // namespace rbs

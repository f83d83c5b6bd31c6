// SPDX-License-Identifier: BSD-3-Clause
#include "state_publisher.h"

#include "convert.h"

#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyStates.h>
#include <rigid_body_sim/Contacts.h>

#include <algorithm>
#include <unordered_map>

namespace rbs {

namespace {
constexpr double kLongestPeriod = 1e8;  // s; a ros::WallDuration holds no more than 2^31
}

StatePublisher::StatePublisher(ros::NodeHandle& node, double contacts_rate, double repeat_period)
    : contacts_period_(contacts_rate > 0.0 ? std::min(1.0 / contacts_rate, kLongestPeriod) : 0.0),
      repeat_period_(repeat_period),
      descriptions_(node.advertise<rigid_body_sim::BodyDescriptions>("body_descriptions", 1, true)),
      states_(Topic::of<rigid_body_sim::BodyStates>(node, "body_states", 10)),
      contacts_(Topic::of<rigid_body_sim::Contacts>(node, "contacts", 10)) {}

bool StatePublisher::hasNewcomer() {
  const bool of_states = states_.hasNewcomer(), of_contacts = contacts_.hasNewcomer();
  if (of_contacts) contacts_sent_ = ros::WallTime();  // who need not wait for his first message
  return of_states || of_contacts;
}

void StatePublisher::publish(const Timeline::Moment& moment) {
  const ros::WallTime now = ros::WallTime::now();
  // Also for those who share a connection with a listener that was there before: roscpp tells of none.
  const bool again = !repeat_period_.isZero() && now - descriptions_sent_ >= repeat_period_ &&
                     descriptions_.getNumSubscribers() > 0;
  if (again || moment.snapshot->bodies != described_) {
    descriptions_sent_ = now;
    publishDescriptions(moment);
  }
  if (states_.wanted(moment.changed || again)) publishStates(moment);
  contacts_due_ = contacts_due_ || moment.changed;
  if (now - contacts_sent_ < contacts_period_ || !contacts_.wanted(contacts_due_)) return;
  contacts_due_ = false;
  contacts_sent_ = now;
  publishContacts(moment);
}

void StatePublisher::publishDescriptions(const Timeline::Moment& moment) {
  described_ = moment.snapshot->bodies;
  rigid_body_sim::BodyDescriptions message;
  message.header.stamp = moment.stamp;
  message.header.frame_id = worldFrame();
  message.scene = moment.snapshot->scene;
  message.version = moment.snapshot->description_version;
  for (const BodyDescription& body : *described_) message.bodies.push_back(toMsg(body));
  descriptions_.publish(message);
}

void StatePublisher::publishStates(const Timeline::Moment& moment) {
  const Snapshot& snapshot = *moment.snapshot;
  rigid_body_sim::BodyStates message;
  message.header.stamp = moment.stamp;
  message.header.frame_id = worldFrame();
  message.version = snapshot.description_version;
  message.ids.reserve(snapshot.states.size());
  message.poses.reserve(snapshot.states.size());
  message.twists.reserve(snapshot.states.size());
  for (const BodyState& state : snapshot.states) {
    message.ids.push_back(state.id.serial);
    message.poses.push_back(toMsg(state.pose));
    message.twists.push_back(toMsg(state.twist));
  }
  states_.send(message);
}

void StatePublisher::publishContacts(const Timeline::Moment& moment) {
  std::unordered_map<std::uint64_t, std::string> names;
  for (const BodyDescription& body : *moment.snapshot->bodies) names[body.id.serial] = body.name;
  rigid_body_sim::Contacts message;
  message.header.stamp = moment.stamp;
  message.header.frame_id = worldFrame();
  for (const ContactPoint& contact : moment.snapshot->contacts) {
    rigid_body_sim::Contact point;
    point.body_a = names[contact.a.serial];
    point.body_b = names[contact.b.serial];
    point.position = toPoint(contact.p_W);
    point.normal = toMsg(contact.n_W);
    point.separation = finite(contact.separation);
    point.normal_impulse = finite(contact.normal_impulse);
    point.friction_impulse = toMsg(contact.friction_impulse);
    point.touching_steps = contact.touching_steps;
    message.contacts.push_back(point);
  }
  contacts_.send(message);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "event_publisher.h"

#include "words.h"

#include <rigid_body_sim/Event.h>

#include <algorithm>
#include <map>

namespace rbs {
namespace {

bool isEdited(const BodyDescription& before, const BodyDescription& now) {
  return describe(before) != describe(now) || before.color != now.color || before.group != now.group ||
         before.mask != now.mask || before.material.drag_coefficient != now.material.drag_coefficient;
}

}  // namespace

EventPublisher::EventPublisher(ros::NodeHandle& node)
    : publisher_(node.advertise<rigid_body_sim::Event>("events", 1000)) {}

void EventPublisher::publish(const Timeline::Moment& moment) {
  stamp_ = moment.stamp;
  const std::shared_ptr<const Snapshot> before = last_ ? last_ : moment.snapshot;
  last_ = moment.snapshot;
  for (const Timeline::Replacement& event : moment.replacements) send(event.kind, "", event.text);
  if (before->world == last_->world) {
    if (before->bodies != last_->bodies) compareBodies(*before, *last_);
    compareSurroundings(*before, *last_);
  }
  compareRun(*before, *last_);
}

void EventPublisher::compareBodies(const Snapshot& before, const Snapshot& now) {
  std::map<BodyId, const BodyDescription*> gone;
  for (const BodyDescription& body : *before.bodies) gone[body.id] = &body;
  for (const BodyDescription& body : *now.bodies) {
    const auto old = gone.find(body.id);
    if (old == gone.end()) {
      send("spawned", body.name, describe(body));
      continue;
    }
    if (old->second->name != body.name) send("edited", body.name, "renamed from '" + old->second->name + "'");
    if (isEdited(*old->second, body)) send("edited", body.name, describe(body));
    gone.erase(old);
  }
  for (const auto& [id, body] : gone) send("deleted", body->name, "");
}

void EventPublisher::compareSurroundings(const Snapshot& before, const Snapshot& now) {
  if (before.gravity != now.gravity) send("edited", "", words("gravity ", inWords(now.gravity), " m/s^2"));
  if (describe(before.air) != describe(now.air)) send("edited", "", describe(now.air));
}

void EventPublisher::compareRun(const Snapshot& before, const Snapshot& now) {
  if (before.dial_reason != now.dial_reason && !now.dial_reason.empty())
    ROS_INFO_STREAM_NAMED("dial", now.dial_reason);
  if (before.paused != now.paused) send(now.paused ? "paused" : "resumed", "", words("at ", now.time, " s"));
  for (std::size_t k = 0; k < now.pipeline.size() && k < before.pipeline.size(); ++k) {
    const StageInfo& stage = now.pipeline[k];
    if (stage.active != before.pipeline[k].active)
      ROS_INFO_STREAM_NAMED("pipeline", stage.name << (stage.active ? " on: " : " off: ") << stage.reason);
  }
  for (const Warning& warning : new_warnings_.take(now))
    send("warning", "", warning.kind + ": " + warning.text);
}

void EventPublisher::send(const std::string& kind, const std::string& body, const std::string& text) {
  if (kind == "warning") ROS_WARN_STREAM_NAMED("simulation", text);
  if (publisher_.getNumSubscribers() == 0) return;
  rigid_body_sim::Event event;
  event.header.stamp = stamp_;
  event.kind = kind;
  event.body = body;
  event.text = text;
  publisher_.publish(event);
}

}  // namespace rbs

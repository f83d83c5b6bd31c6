// SPDX-License-Identifier: BSD-3-Clause
#include "markers.h"

#include <algorithm>
#include <map>

#include "convert.h"

namespace rbs {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr std::size_t kMostMeshes = 100;  // of moving bodies
constexpr std::size_t kMostMoved = 333;   // in a message: 10,000 a second, which RViz can take in

// A ten-thousandth of the body, or of a radian, is less than a pixel.
bool visiblyApart(const Pose& a, const Pose& b, double size) {
  constexpr double kVisible = 1e-4;
  return (b.p_WB - a.p_WB).norm() > kVisible * size || a.q_WB.angularDistance(b.q_WB) > kVisible;
}

void append(const std::vector<Marker>& markers, MarkerArray& news) {
  news.markers.insert(news.markers.end(), markers.begin(), markers.end());
}

}  // namespace

MarkerPublisher::MarkerPublisher(ros::NodeHandle& private_node, const std::string& topic,
                                 const std::string& group, TfMode tf, const std::string& tf_prefix,
                                 double repeat_period)
    : bodies_ns_(private_node.resolveName(group)),
      fluid_ns_(private_node.resolveName("fluid")),
      tf_(tf),
      tf_prefix_(tf_prefix),
      repeat_period_(repeat_period) {
  constexpr int kQueue = 100;
  std::lock_guard<std::mutex> lock(mutex_);
  publisher_ = private_node.advertise<MarkerArray>(
      topic, kQueue, [this](const ros::SingleSubscriberPublisher& newcomer) { greet(newcomer); });
}

// The first one gets all by the next message, as there is nothing yet to greet him with.
void MarkerPublisher::greet(const ros::SingleSubscriberPublisher& newcomer) {
  std::lock_guard<std::mutex> lock(mutex_);
  begun_ = true;
  MarkerArray all;
  for (const Shown& shown : shown_) append(shown.markers, all);
  if (water_) all.markers.push_back(*water_);
  if (!all.markers.empty()) newcomer.publish(all);
}

void MarkerPublisher::publish(const Snapshot& snapshot) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!begun_) return;
  if (publisher_.getNumSubscribers() == 0) {
    begun_ = false;
    shown_.clear();
    water_.reset();
    described_.reset();
    return;
  }
  MarkerArray removals, news;
  if (snapshot.bodies != described_) follow(snapshot, removals);
  move(snapshot);
  repeat();
  flood(snapshot, removals, news);
  collect(news);
  // Two messages, since RViz warns of a marker that one message both takes away and adds.
  for (const MarkerArray& message : {removals, news}) {
    if (!message.markers.empty()) publisher_.publish(message);
  }
}

std::vector<MarkerLook> MarkerPublisher::looksOf(const Snapshot& snapshot) const {
  std::vector<MarkerLook> looks;
  std::size_t movable = 0;
  for (const BodyDescription& body : *snapshot.bodies) {
    std::string frame = worldFrame();
    bool is_mesh = true;
    if (body.kind != BodyKind::Static) {
      const bool has_frame = tf_ == TfMode::All && movable < TfPublisher::kMostBodies;
      if (has_frame) frame = tf_prefix_ + body.name;
      is_mesh = has_frame && movable < kMostMeshes;
      ++movable;
    }
    looks.push_back(lookOf(body, bodies_ns_, frame, is_mesh, snapshot.view));
  }
  return looks;
}

// The surface of the fluid: a square about the scene, under what looks at it.
void MarkerPublisher::flood(const Snapshot& snapshot, MarkerArray& removals, MarkerArray& news) {
  std::optional<Marker> water;
  if (snapshot.fluid) water = waterMarker(*snapshot.fluid, fluid_ns_, snapshot.view);
  if (water && water_due_) water_.reset();
  if (water_ &&
      (!water || water->pose.position.z != water_->pose.position.z || water->scale.x != water_->scale.x)) {
    if (!water) removals.markers.push_back(removalOf(*water_));
    water_.reset();
  }
  if (water && !water_) news.markers.push_back(*water);
  water_ = water;
  water_due_ = false;
}

// A marker of the same (ns, id) in the same frame takes the place of the old one and needs no DELETE. RViz
// keeps a marker locked that once was, so where the frame changes the old one is taken away first.
void MarkerPublisher::follow(const Snapshot& snapshot, MarkerArray& removals) {
  std::map<BodyId, Shown> old;
  for (Shown& shown : shown_) old.emplace(shown.id, std::move(shown));
  shown_.clear();
  const std::vector<MarkerLook> looks = looksOf(snapshot);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const BodyState& state = snapshot.states[i];
    const auto it = old.find(state.id);
    if (it != old.end() && it->second.look == looks[i]) {
      shown_.push_back(std::move(it->second));
      old.erase(it);
      continue;
    }
    shown_.push_back({state.id, looks[i], state.pose, markersOf(state.id, looks[i], state.pose)});
    if (it != old.end() && it->second.look.frame == looks[i].frame &&
        it->second.markers.size() <= shown_.back().markers.size()) {
      old.erase(it);
    }
  }
  for (const auto& [id, gone] : old) {
    for (const Marker& marker : gone.markers) removals.markers.push_back(removalOf(marker));
  }
  described_ = snapshot.bodies;
}

// In turn where more have moved than a message may hold.
void MarkerPublisher::move(const Snapshot& snapshot) {
  std::size_t room = kMostMoved;
  for (std::size_t k = 0; k < shown_.size() && room > 0; ++k) {
    moved_ = (moved_ + 1) % shown_.size();
    Shown& shown = shown_[moved_];
    const Pose& pose = snapshot.states[moved_].pose;
    const bool is_locked = shown.look.frame != worldFrame();
    if (is_locked || !isFinite(pose) || !visiblyApart(shown.pose, pose, drawnSize(shown.look))) continue;
    shown.pose = pose;
    shown.due = true;
    --room;
    for (Marker& marker : shown.markers) marker.pose = toMsg(pose);
  }
}

// A few at a time, in turn: all at once would make RViz stutter.
void MarkerPublisher::repeat() {
  const ros::WallTime now = ros::WallTime::now();
  const double passed = (now - repeated_).toSec();
  repeated_ = now;
  if (repeat_period_ == 0.0) return;
  const std::size_t turns = shown_.size() + 1;  // the last one is the water's
  for (repeats_ += turns * std::min(1.0, passed / repeat_period_); repeats_ >= 1.0; repeats_ -= 1.0) {
    next_ = (next_ + 1) % turns;
    (next_ < shown_.size() ? shown_[next_].due : water_due_) = true;
  }
}

void MarkerPublisher::collect(MarkerArray& news) {
  for (Shown& shown : shown_) {
    if (shown.due) append(shown.markers, news);
    shown.due = false;
  }
}

}  // namespace rbs

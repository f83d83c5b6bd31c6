// SPDX-License-Identifier: BSD-3-Clause
#include "marker_board.h"

#include "convert.h"

namespace rbs {
namespace {

// A thousandth of the marker's scale, or of a radian, is less than a pixel.
bool visiblyApart(const geometry_msgs::Pose& a, const geometry_msgs::Pose& b, double scale) {
  constexpr double kVisible = 1e-3;
  const Pose from = fromMsg(a), to = fromMsg(b);
  return (to.p_WB - from.p_WB).norm() > kVisible * scale || from.q_WB.angularDistance(to.q_WB) > kVisible;
}

bool looksSame(visualization_msgs::InteractiveMarker a, const visualization_msgs::InteractiveMarker& b) {
  a.pose = b.pose;
  return a == b;
}

}  // namespace

MarkerBoard::MarkerBoard(const std::string& topic, Callback callback)
    : server_(topic), callback_(std::move(callback)) {}

void MarkerBoard::show(const visualization_msgs::InteractiveMarker& marker) {
  if (gripped_.count(marker.name)) return;
  const auto it = shown_.find(marker.name);
  if (it != shown_.end() && looksSame(it->second, marker)) return move(marker.name, marker.pose);
  server_.insert(marker, callback_);
  shown_[marker.name] = marker;
}

void MarkerBoard::move(const std::string& name, const geometry_msgs::Pose& pose) {
  const auto it = shown_.find(name);
  if (it == shown_.end() || gripped_.count(name)) return;
  if (!visiblyApart(it->second.pose, pose, it->second.scale)) return;
  server_.setPose(name, pose);
  it->second.pose = pose;
}

void MarkerBoard::erase(const std::string& name) {
  gripped_.erase(name);
  shown_.erase(name);
  server_.erase(name);
}

void MarkerBoard::letGo(const std::string& name) {
  if (const auto it = gripped_.find(name); it != gripped_.end()) gripped_.erase(it);
  putBack(name);
}

void MarkerBoard::putBack(const std::string& name) {
  if (const auto it = shown_.find(name); it != shown_.end()) server_.setPose(name, it->second.pose);
}

}  // namespace rbs

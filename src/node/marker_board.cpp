// SPDX-License-Identifier: BSD-3-Clause
#include "marker_board.h"

#include "body_markers.h"
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

MarkerBoard::MarkerBoard(const std::string& topic, const std::string& selection_topic, Callback callback)
    : all_(topic), of_selection_(selection_topic), callback_(std::move(callback)) {}

void MarkerBoard::publish() {
  all_.applyChanges();
  of_selection_.applyChanges();
}

// A server leaves out what it does not have.
void MarkerBoard::setPose(const std::string& name, const geometry_msgs::Pose& pose) {
  all_.setPose(name, pose);
  of_selection_.setPose(name, pose);
}

void MarkerBoard::show(const visualization_msgs::InteractiveMarker& marker) {
  if (gripped_.count(marker.name)) return;
  const auto it = shown_.find(marker.name);
  if (it != shown_.end() && looksSame(it->second, marker)) return move(marker.name, marker.pose);
  all_.insert(marker, callback_);
  if (isOfSelection(marker.name)) of_selection_.insert(marker, callback_);
  shown_[marker.name] = marker;
}

void MarkerBoard::move(const std::string& name, const geometry_msgs::Pose& pose) {
  const auto it = shown_.find(name);
  if (it == shown_.end() || gripped_.count(name)) return;
  if (!visiblyApart(it->second.pose, pose, it->second.scale)) return;
  setPose(name, pose);
  it->second.pose = pose;
}

void MarkerBoard::erase(const std::string& name) {
  gripped_.erase(name);
  shown_.erase(name);
  all_.erase(name);
  of_selection_.erase(name);
}

void MarkerBoard::letGo(const std::string& name) {
  if (const auto it = gripped_.find(name); it != gripped_.end()) gripped_.erase(it);
  putBack(name);
}

void MarkerBoard::putBack(const std::string& name) {
  if (const auto it = shown_.find(name); it != shown_.end()) setPose(name, it->second.pose);
}

}  // namespace rbs

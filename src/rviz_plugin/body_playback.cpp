// SPDX-License-Identifier: BSD-3-Clause
#include "body_playback.h"

#include <algorithm>
#include <cmath>

namespace rbs {

void PlaybackClock::add(double stamp, double arrival) {
  constexpr double kWindow = 0.5;  // s of wall time over which rates are taken
  recent_.push_back({stamp, arrival});
  while (recent_.size() > 2 && arrival - recent_.front().arrival > kWindow) recent_.pop_front();
  if (recent_.size() == 2 && arrival - recent_.front().arrival > kWindow) recent_.pop_front();
}

// The line through the middle of the recent arrivals with their mean rate: one that came early or late moves
// it by little.
double PlaybackClock::at(double now) {
  constexpr double kMostDelay = 0.25;  // s of wall time
  if (recent_.empty()) return shown_;
  const Arrival &first = recent_.front(), &last = recent_.back();
  double stamp = last.stamp;
  if (last.arrival > first.arrival) {
    const auto count = static_cast<double>(recent_.size());
    const double interval = (last.arrival - first.arrival) / (count - 1.0);
    const double rate = (last.stamp - first.stamp) / (last.arrival - first.arrival);
    double mean_stamp = 0.0, mean_arrival = 0.0;
    for (const Arrival& one : recent_) {
      mean_stamp += one.stamp / count;
      mean_arrival += one.arrival / count;
    }
    stamp = mean_stamp + rate * (now - std::min(1.5 * interval, kMostDelay) - mean_arrival);
  }
  shown_ = std::clamp(stamp, std::min(shown_, last.stamp), last.stamp);
  return shown_;
}

void PlaybackClock::clear() {
  recent_.clear();
  shown_ = 0.0;
}

// Descriptions are sent again and again, so the same version with the same bodies is no news.
void BodyPlayback::add(std::shared_ptr<const BodyCatalog> catalog) {
  next_ = std::move(catalog);
  if (!waiting_ || !match(*next_, *waiting_)) {
    if (catalog_ && !frames_.empty() && match(*next_, *frames_.back())) catalog_ = next_;
    return;
  }
  const std::shared_ptr<const BodyFrame> frame = std::move(waiting_);
  waiting_.reset();
  add(frame);
}

void BodyPlayback::add(std::shared_ptr<const BodyFrame> frame) {
  waiting_.reset();
  if (catalog_ && match(*catalog_, *frame)) return show(frame);
  if (!next_ || !match(*next_, *frame)) {
    waiting_ = std::move(frame);
    return;
  }
  catalog_ = next_;
  frames_.clear();
  clock_.clear();
  show(frame);
}

void BodyPlayback::show(const std::shared_ptr<const BodyFrame>& frame) {
  constexpr std::size_t kMost = 64;  // where no picture is drawn for long
  if (!frames_.empty() && frame->stamp <= frames_.back()->stamp) {
    frames_.clear();
    clock_.clear();
  }
  frames_.push_back(frame);
  if (frames_.size() > kMost) frames_.pop_front();
  clock_.add(frame->stamp, frame->arrival);
}

void BodyPlayback::clear() {
  *this = BodyPlayback();
}

const std::vector<BodyPlace>& BodyPlayback::at(double now) {
  if (frames_.empty()) {
    shown_.clear();
    return shown_;
  }
  stamp_ = std::max(clock_.at(now), frames_.front()->stamp);
  while (frames_.size() > 1 && frames_[1]->stamp <= stamp_) frames_.pop_front();
  shown_ = frames_[0]->places;
  if (frames_.size() == 1) return shown_;
  const double seconds = frames_[1]->stamp - frames_[0]->stamp;
  const auto share = static_cast<float>((stamp_ - frames_[0]->stamp) / seconds);
  for (std::size_t k = 0; k < shown_.size(); ++k)
    shown_[k] = between(shown_[k], frames_[1]->places[k], share, static_cast<float>(seconds));
  return shown_;
}

BodyPlace between(const BodyPlace& a, const BodyPlace& b, float share, float seconds) {
  constexpr float kSlack = 2.0f;    // of what the velocities allow: it may have been faster in between
  constexpr float kAnyway = 0.02f;  // m and rad that are no jump to the eye
  const Ogre::Vector3 way = b.position - a.position;
  const float turn = 2.0f * std::acos(std::min(1.0f, std::abs(a.orientation.Dot(b.orientation))));
  const float fastest = std::max(a.velocity.length(), b.velocity.length());
  const bool has_jumped = way.length() > kSlack * fastest * seconds + kAnyway ||
                          turn > kSlack * std::max(a.turn_rate, b.turn_rate) * seconds + kAnyway;
  if (has_jumped) return share < 1.0f ? a : b;
  return {a.position + share * way, Ogre::Quaternion::nlerp(share, a.orientation, b.orientation, true),
          a.velocity + share * (b.velocity - a.velocity), a.turn_rate + share * (b.turn_rate - a.turn_rate)};
}

}  // namespace rbs

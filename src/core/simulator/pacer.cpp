// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/pacer.h"

#include <algorithm>

namespace rbs {
namespace {

constexpr double kLargestLag = 0.1;   // lateness in wall time that is still caught up, s; more is dropped
constexpr double kSpeedWindow = 1.0;  // over which the achieved speed is averaged, s
constexpr double kSampling = 0.02;    // between two samples of it, s
constexpr double kShortestPicture = 1.0 / 80.0;  // between two pictures, s; nobody reads them more often
constexpr double kLongestPicture = 0.1;          // s of wall time: ten pictures a second
constexpr double kPictureShare = 0.1;            // largest fraction of the time that pictures take
constexpr double kLongestInterval = 1e8;         // s: a clock counts nanoseconds up to 292 years

double seconds(Pacer::Clock::duration d) {
  return std::chrono::duration<double>(d).count();
}
Pacer::Clock::duration duration(double s) {
  return std::chrono::duration_cast<Pacer::Clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

double Pacer::left(Time now) const {
  return interval_ > 0.0 ? std::clamp(seconds(next_step_ - now) / interval_, 0.0, 1.0) : 0.0;
}

// The step before the first counts as one that ended an interval before it.
void Pacer::restart(Time now, double speed, double step, double left) {
  speed_ = speed;
  interval_ = speed > 0.0 ? std::min(step / speed, kLongestInterval) : 0.0;
  next_step_ = now + duration(left * interval_);
  lost_ = 0.0;
  last_ = {next_step_ - duration(interval_), 0.0};
  samples_ = {last_};
  step_seconds_ = 0.0;
}

void Pacer::stepped(Time begin, Time end, double step) {
  last_ = {end, last_.physics + step};
  step_seconds_ = seconds(end - begin);
  if (seconds(end - samples_.back().wall) >= kSampling) samples_.push_back(last_);
  while (samples_.size() > 2 && seconds(end - samples_[1].wall) > kSpeedWindow) samples_.pop_front();
  if (speed_ == 0.0) return;
  next_step_ += duration(interval_);
  const double lag = seconds(end - next_step_);
  if (lag <= kLargestLag) return;
  lost_ += lag * speed_;
  next_step_ = end;
}

Pacer::Time Pacer::nextPicture() const {
  const double period = std::clamp(picture_seconds_ / kPictureShare, kShortestPicture, kLongestPicture);
  return last_picture_ + duration(std::min(period, std::max(0.0, kLongestPicture - step_seconds_)));
}

void Pacer::pictured(Time begin, Time end) {
  last_picture_ = begin;
  picture_seconds_ = seconds(end - begin);
}

double Pacer::late(Time now) const {
  return std::max(0.0, seconds(now - last_.wall) - interval_);
}

double Pacer::achievedSpeed(Time now) const {
  const double wall = seconds(last_.wall - samples_.front().wall) + late(now);
  return wall < kLargestLag ? speed_ : (last_.physics - samples_.front().physics) / wall;
}

}  // namespace rbs

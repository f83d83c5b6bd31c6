// SPDX-License-Identifier: BSD-3-Clause
#include "player.h"

#include "words.h"

#include "rigid_body_sim/types.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>
#include <cmath>
#include <exception>

namespace rbs {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kPeriod = 1.0 / 80.0;                   // s of wall time, as the simulator has it
constexpr std::chrono::milliseconds kStatusPeriod(100);  // also while paused
constexpr double kFastest = 100.0;                       // times real time; listeners take no more
constexpr std::size_t kMostAtOnce = 4;                   // messages of a topic in a period: of more, the last
constexpr double kSecond = 1e9;                          // ns
const std::string kStatus = "status", kStates = "body_states";

ros::Time toTime(Nanoseconds time) {
  ros::Time stamp;
  stamp.fromNSec(static_cast<std::uint64_t>(std::max<Nanoseconds>(0, time)));
  return stamp;
}

double inSeconds(Nanoseconds time) {
  return static_cast<double>(time) / kSecond;
}

}  // namespace

// The stamps begin as they were recorded.
Player::Player(const Recording& recording, const Options& options)
    : recording_(recording),
      sends_clock_(options.clock),
      paused_(options.paused),
      speed_(options.speed),
      shift_(recording.begin()),
      floor_(recording.begin()),
      clock_(recording.begin() - 1),
      ticked_(SteadyClock::now()),
      node_(recording.simulator()),
      outlets_(makeOutlets(node_)),
      spinner_(1, &queue_) {
  if (sends_clock_) clock_topic_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  status_topic_ = node_.advertise<rigid_body_sim::Status>(kStatus, 10);
  for (const Recording::Channel& channel : recording.channels()) {
    const auto outlet = outlets_.find(channel.topic);
    outlets_of_channels_.push_back(outlet == outlets_.end() ? nullptr : outlet->second.get());
  }
  show(true);
  ros::WallTimerOptions timer(
      ros::WallDuration(kPeriod), [this](const ros::WallTimerEvent&) { tick(); }, &queue_);
  timer_ = node_.createWallTimer(timer);
  spinner_.start();
}

Player::~Player() {
  spinner_.stop();
}

void Player::pause() {
  const std::lock_guard<std::mutex> lock(mutex_);
  paused_ = true;
  sendStatus();
}

void Player::resume() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (isAtEnd()) {
    position_ = 0;
    show(false);
  }
  paused_ = false;
  sendStatus();
}

void Player::togglePause() {
  bool was_paused;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    was_paused = paused_;
  }
  was_paused ? resume() : pause();
}

void Player::goToStart() {
  const std::lock_guard<std::mutex> lock(mutex_);
  position_ = 0;
  show(false);
}

void Player::setSpeed(double speed) {
  constexpr double kMost = 1e6;
  if (!(speed >= 0.0 && speed <= kMost))
    throw InvalidInput({{"factor", words(speed), "a number from 0 to 1e6"}});
  const std::lock_guard<std::mutex> lock(mutex_);
  speed_ = speed;
  sendStatus();
}

std::uint32_t Player::step(std::uint32_t n) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!paused_) throw InvalidInput({{"step", "", "the replay must be paused"}});
  const std::uint32_t taken = std::min(std::max(n, 1u), recording_.statesAfter(count_));
  if (taken > 0) {
    const std::size_t count = recording_.countUntilState(count_, taken);
    position_ = recording_.entries()[count - 1].time;
    playUntil(count);
  }
  sendClock();
  sendStatus();
  return taken;
}

void Player::seek(double time) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double length = inSeconds(recording_.length());
  constexpr double kRounding = 0.5e-9;  // s: times are those of whole nanoseconds
  if (!(time >= 0.0 && time <= length + kRounding))
    throw InvalidInput({{"time", words(time), words("a time of the recording, 0 to ", length, " s")}});
  position_ = std::min(static_cast<Nanoseconds>(std::llround(time * kSecond)), recording_.length());
  show(false);
}

std::string Player::inWords() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return words(paused_ ? "paused" : "playing", " at ", inSeconds(position_), " s of ",
               inSeconds(recording_.length()), " s");
}

double Player::seconds() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return inSeconds(position_);
}

void Player::tick() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const SteadyClock::time_point now = SteadyClock::now();
  const double passed = std::chrono::duration<double>(now - ticked_).count();
  ticked_ = now;
  if (!paused_) {
    const double speed = speed_ == 0.0 ? kFastest : std::min(speed_, kFastest);
    const double next = static_cast<double>(position_) + kSecond * speed * passed;
    position_ = next < static_cast<double>(recording_.length()) ? static_cast<Nanoseconds>(next)
                                                                : recording_.length();
    playUntil(recording_.countUntil(position_));
    if (isAtEnd()) paused_ = true, status_due_ = true;
  }
  if (hasNewcomer()) show(false);
  sendClock();
  if (status_due_ || now - status_sent_ >= kStatusPeriod) sendStatus();
}

// Where more messages are due than listeners can take, only the last of those that say all.
void Player::playUntil(std::size_t count) {
  std::vector<std::size_t> due(recording_.channels().size());
  const std::vector<Recording::Entry>& entries = recording_.entries();
  for (std::size_t k = count_; k < count; ++k) ++due[entries[k].channel];
  std::vector<bool> is_crowded(due.size());
  for (std::size_t c = 0; c < due.size(); ++c) {
    const bool says_all = outletOf(c) ? outletOf(c)->says() == Outlet::Says::All : true;
    is_crowded[c] = says_all && due[c] > kMostAtOnce;
  }
  for (; count_ < count; ++count_) {
    const std::size_t channel = entries[count_].channel;
    if (--due[channel] == 0 || !is_crowded[channel]) play(entries[count_]);
  }
}

// What is damaged is left out: the rest of a recording may still be whole.
void Player::play(const Recording::Entry& entry) {
  const std::string& topic = recording_.channels()[entry.channel].topic;
  try {
    if (topic == kStatus) return keepStatus(entry);
    Outlet* const outlet = outletOf(entry.channel);
    if (outlet && outlet->wanted()) outlet->send(entry.message, restampOf(entry));
  } catch (const std::exception& error) {
    ROS_WARN_THROTTLE(1.0, "a message of %s at %.3f s is damaged: %s", topic.c_str(), inSeconds(entry.time),
                      error.what());
  }
}

// The state that is shown gets a stamp after all others of before. So all that is earlier than the state is
// stamped by the floor. A status, without which no panel hears a replay, is shown also before the first one.
void Player::show(bool with_selection) {
  count_ = recording_.countUntil(position_);
  Nanoseconds earliest = position_;
  for (const Recording::Channel& channel : recording_.channels()) {
    if (channel.topic != kStates && channel.topic != kStatus) continue;
    if (const Recording::Entry* const entry = recording_.last(channel, count_))
      earliest = std::min(earliest, entry->time);
  }
  floor_ = clock_ + 1;
  shift_ = floor_ - earliest;
  status_.reset();
  for (std::size_t c = 0; c < recording_.channels().size(); ++c) {
    const Recording::Channel& channel = recording_.channels()[c];
    const bool is_status = channel.topic == kStatus;
    const Recording::Entry* entry = recording_.last(channel, count_);
    if (!entry) continue;
    const Outlet* const outlet = outletOf(c);
    const bool holds = outlet && (outlet->says() == Outlet::Says::All ||
                                  (with_selection && outlet->says() == Outlet::Says::Event));
    if (is_status || holds) play(*entry);
  }
  for (const Recording::Channel& channel : recording_.channels())
    if (!status_ && channel.topic == kStatus && !channel.entries.empty())
      play(recording_.entries()[channel.entries.front()]);
  showMarkers();
  sendClock();
  sendStatus();
}

void Player::showMarkers() {
  for (const auto& [channel, history] : recording_.markers()) {
    Outlet* const outlet = outletOf(channel);
    if (!outlet || !outlet->wanted()) continue;
    outlet->clear();
    for (const auto& [number, places] : history.standing(count_)) {
      const Recording::Entry& entry = recording_.entries()[number];
      try {
        outlet->sendPart(entry.message, places, restampOf(entry));
      } catch (const std::exception&) {  // it is damaged: the index has read it, but a disk may fail
      }
    }
  }
}

bool Player::hasNewcomer() {
  bool has = false;
  for (const auto& [topic, outlet] : outlets_) has = outlet->hasNewcomer() || has;
  return has;
}

Nanoseconds Player::clockNow() const {
  return std::max(clock_, position_ + shift_);
}

Restamp Player::restampOf(const Recording::Entry& entry) const {
  return [shift = entry.offset + shift_, floor = floor_](const ros::Time& stamp) {
    return toTime(std::max(static_cast<Nanoseconds>(stamp.toNSec()) + shift, floor));
  };
}

void Player::keepStatus(const Recording::Entry& entry) {
  status_ = entry.message.instantiate<rigid_body_sim::Status>();
  if (status_) status_->header.stamp = restampOf(entry)(status_->header.stamp);
  status_due_ = true;
}

// The pace is that of the replay, and what has been edited is not this one's to undo.
void Player::sendStatus() {
  if (!status_) return;
  status_sent_ = SteadyClock::now();
  status_due_ = false;
  rigid_body_sim::Status status = *status_;
  status.paused = paused_;
  status.requested_speed = speed_;
  status.achieved_speed = paused_ ? 0.0 : speed_ == 0.0 ? kFastest : std::min(speed_, kFastest);
  status.lost_time = 0.0;
  status.bottleneck.clear();
  status.steps_left = 0;
  status.undo.clear();
  status.redo.clear();
  status.unsaved = false;
  status.recording = {inSeconds(position_), inSeconds(recording_.length())};
  status_topic_.publish(status);
}

void Player::sendClock() {
  clock_ = clockNow();
  if (!sends_clock_) return;
  rosgraph_msgs::Clock now;
  now.clock = toTime(clock_);
  clock_topic_.publish(now);
}

}  // namespace rbs

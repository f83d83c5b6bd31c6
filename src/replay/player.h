// SPDX-License-Identifier: BSD-3-Clause
// Player: plays a recording on the topics of its simulator, at any pace and from any time on.
//
// The stamps of what it publishes only go forward, as those of a simulator do: a seek moves the recording along the line of
// the stamps, and not the other way round.
#pragma once

#include "outlets.h"
#include "recording.h"

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/spinner.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace rbs {

/// Thread-safe. It plays on wall time, in a thread of its own.
class Player {
 public:
  /// How it begins.
  struct Options {
    bool paused = false;  ///< whether it stands still at first
    double speed = 1.0;   ///< as of setSpeed()
    bool clock = true;    ///< send /clock
  };

  /// Shows the start of the recording, and plays it where Options say so. `recording` must live on.
  Player(const Recording& recording, const Options& options);
  ~Player();

  void pause();  ///< stands still
  /// Plays on; from the start again, where it is at the end.
  void resume();
  void togglePause();  ///< pauses or resumes
  void goToStart();    ///< shows the start, and plays on or not as before
  /// Time of the recording over wall time, 0 to 1e6; 0 is as fast as possible: 100, which listeners can take.
  /// Throws InvalidInput for another one.
  void setSpeed(double speed);
  /// Goes on by n recorded states (0: 1), while paused; returns by how many, which are fewer at the end.
  /// Throws InvalidInput while it plays.
  std::uint32_t step(std::uint32_t n);
  /// Goes to a time, s. Throws InvalidInput for one that is not in the recording.
  void seek(double time);
  /// "paused at 2.5 s of 60 s".
  std::string inWords() const;
  /// The topic of this outlet, such as "selection", for what a viewer adds to it.
  const ros::Publisher& publisherOf(const std::string& topic) const {
    return outlets_.at(topic)->publisher();
  }
  double seconds() const;  ///< where it is, s from the start of the recording

 private:
  void tick();
  void playUntil(std::size_t count);
  void play(const Recording::Entry& entry);
  void show(bool with_selection);
  void showMarkers();
  bool hasNewcomer();
  void keepStatus(const Recording::Entry& entry);
  void sendStatus();
  void sendClock();
  bool isAtEnd() const { return position_ >= recording_.length(); }
  Outlet* outletOf(std::size_t channel) const { return outlets_of_channels_[channel]; }
  Restamp restampOf(const Recording::Entry& entry) const;
  Nanoseconds clockNow() const;

  const Recording& recording_;
  const bool sends_clock_;
  mutable std::mutex mutex_;
  bool paused_;
  double speed_;
  Nanoseconds position_ = 0;  ///< time of the recording that is shown
  std::size_t count_ = 0;     ///< entries up to it
  Nanoseconds shift_;         ///< from the time of the recording to the stamps of the replay
  Nanoseconds floor_;         ///< no stamp is earlier: it follows all of before the last seek
  Nanoseconds clock_;         ///< the last /clock, which no stamp passes
  std::chrono::steady_clock::time_point ticked_, status_sent_;
  rigid_body_sim::StatusPtr status_;  ///< the last one up to the position; null: none yet
  bool status_due_ = false;           ///< it has not been sent
  ros::NodeHandle node_;              ///< of the simulator
  ros::CallbackQueue queue_;          ///< of the timer alone
  ros::Publisher clock_topic_, status_topic_;
  std::map<std::string, std::unique_ptr<Outlet>> outlets_;
  std::vector<Outlet*> outlets_of_channels_;  ///< null for what is not played
  ros::WallTimer timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace rbs

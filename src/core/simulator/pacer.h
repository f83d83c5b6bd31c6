// SPDX-License-Identifier: BSD-3-Clause
// Pacer: computes by the steady clock when the next step and the next picture (a snapshot for readers) are
// due, and the achieved real-time factor.
//
// A simulation that cannot keep up runs slower. It does not freeze: the time that it is behind is dropped and
// counted, and pictures continue at a steady rate.
#pragma once

#include <chrono>
#include <deque>

namespace rbs {

/// Every time point is the caller's, so the same calls give the same answers. Not thread-safe.
class Pacer {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// Begins anew: steps of `step` s at `speed` times real time (0: as fast as possible), the first one due
  /// after this share of the time between two.
  void restart(Time now, double speed, double step, double left = 0.0);
  /// Which share of the time between two steps is left until the next one, 0 to 1.
  double left(Time now) const;

  /// When the next step is due; long ago where the speed is 0.
  Time nextStep() const { return next_step_; }
  /// A step of `step` s was taken.
  void stepped(Time begin, Time end, double step);

  /// When the next picture is due. There are 80 a second, or fewer where they would take more than a tenth of
  /// the time. A picture is due earlier where another step would leave more than 0.1 s between two.
  Time nextPicture() const;
  /// A picture was taken.
  void pictured(Time begin, Time end);

  /// Physics time over wall time in about the last second, up to now. A step that is late counts against it
  /// before it has ended. It is the requested speed as long as there is too little to measure.
  double achievedSpeed(Time now) const;
  /// How much longer ago than the interval between two steps the last one ended, s.
  double late(Time now) const;
  /// Physics time lost since restart(), s: what the requested speed required and the simulation did not
  /// reach.
  double lostTime() const { return lost_; }

 private:
  struct Sample {
    Time wall;
    double physics;  ///< simulated since restart(), s
  };

  double speed_ = 1.0, interval_ = 0.0;  ///< requested real-time factor; wall time from step to step, s
  Time next_step_;
  double lost_ = 0.0;
  std::deque<Sample> samples_;                         ///< of about the last second, the oldest first
  Sample last_{};                                      ///< the end of the last step
  double step_seconds_ = 0.0, picture_seconds_ = 0.0;  ///< wall time of the last ones, s
  Time last_picture_;
};

}  // namespace rbs

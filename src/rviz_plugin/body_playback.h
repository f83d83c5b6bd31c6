// SPDX-License-Identifier: BSD-3-Clause
// Playback: where the bodies are shown between two messages about their states.
#pragma once

#include "body_catalog.h"

#include <deque>
#include <memory>
#include <vector>

namespace rbs {

/// Which stamp to show at which wall time. Stamps advance at the mean rate at which they come, one and a half
/// messages behind, so that the next message is there when it is needed. Never beyond the newest stamp.
class PlaybackClock {
 public:
  /// A message with this stamp has come. Times in s.
  void add(double stamp, double arrival);
  /// The stamp to show, s. It never goes back until clear().
  double at(double now);
  void clear();

 private:
  struct Arrival {
    double stamp, arrival;
  };
  std::deque<Arrival> recent_;
  double shown_ = 0.0;
};

/// Keeps descriptions and states as they come, puts together what belongs together, and interpolates. What is
/// of another version than the descriptions waits for those.
class BodyPlayback {
 public:
  void add(std::shared_ptr<const BodyCatalog> catalog);
  void add(std::shared_ptr<const BodyFrame> frame);
  void clear();

  /// The bodies that are shown; null: none yet.
  const std::shared_ptr<const BodyCatalog>& catalog() const { return catalog_; }
  /// Where those are at the wall time `now`, s.
  const std::vector<BodyPlace>& at(double now);
  /// The stamp of the last at(), s.
  double stamp() const { return stamp_; }
  /// Whether the last states wait for descriptions that belong to them.
  bool waits() const { return waiting_ != nullptr; }
  std::uint64_t awaitedVersion() const { return waiting_ ? waiting_->version : 0; }

 private:
  void show(const std::shared_ptr<const BodyFrame>& frame);

  std::shared_ptr<const BodyCatalog> catalog_,  ///< of what is shown
      next_;                                    ///< that came last, where no state belongs to it yet
  std::shared_ptr<const BodyFrame> waiting_;    ///< the last states, where their descriptions are not here
  std::deque<std::shared_ptr<const BodyFrame>> frames_;  ///< by stamp: the one shown, and those after it
  PlaybackClock clock_;
  double stamp_ = 0.0;
  std::vector<BodyPlace> shown_;
};

/// A body between two states that are `seconds` apart; `share` 0 to 1. Where it has jumped, which is farther
/// than its velocities can take it, it stays where it was until the second.
BodyPlace between(const BodyPlace& a, const BodyPlace& b, float share, float seconds);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Recorder: the commands and checkpoints of a simulator, in order, while somebody wants them.
#pragma once

#include "rigid_body_sim/recording.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace rbs {

/// Used by the simulator's thread alone. Without a keeper it does nothing.
class Recorder {
 public:
  using Keep = std::function<void(Recorded)>;

  /// Hands all entries to `keep` from now on, the first being a checkpoint, and then one every `period` s of
  /// physics time. Empty: to nobody.
  void begin(Keep keep, double period, World& world, std::uint64_t number);
  /// To be called when the simulator has another world: a checkpoint.
  void attach(World& world, std::uint64_t number);
  /// To be called when the world went back to a copy of what it was.
  void listen(World& world);
  /// flush(), and the world is no longer listened to. To be called before it is replaced.
  void leave(World& world);
  /// Hands over the commands since the last call as one entry. To be called after each batch of edits.
  void flush(const World& world);
  /// flush(), and a checkpoint where one is due. To be called after each step.
  void stepped(const World& world);

  /// Commands since the last flush(), and dropping those after the first n: the world went back to before them.
  std::size_t pending() const { return pending_.size(); }
  void drop(std::size_t n) { pending_.resize(n); }
  /// Entries handed over so far, to any keeper.
  std::uint64_t kept() const { return kept_; }

 private:
  void checkpoint(const World& world);

  Keep keep_;
  double period_ = 0.0;
  double next_ = 0.0;         // physics time of the next checkpoint, s
  std::uint64_t number_ = 0;  // of the world
  std::uint64_t kept_ = 0;
  Recorded::Commands pending_;
};

}  // namespace rbs

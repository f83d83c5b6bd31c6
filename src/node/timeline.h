// SPDX-License-Identifier: BSD-3-Clause
// Timeline: the stamps of what the node publishes, on a line of time that never goes back.
//
// Physics time starts again at 0 whenever the world is replaced. The stamps go on: they advance with the
// physics, and by a nanosecond where an edit changes the world while time stands still, because tf drops
// a second transform with the stamp of the first.
#pragma once

#include "rigid_body_sim/simulator.h"

#include <ros/time.h>

#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace rbs {

class Timeline {
 public:
  /// With `wall` the stamps are those of the wall clock instead.
  Timeline(const Snapshot& first, bool wall);

  /// That the world was replaced by another.
  struct Replacement {
    std::string kind;  ///< of the event: "loaded" or "reset"
    std::string text;
  };

  /// What is published at one moment.
  struct Moment {
    std::shared_ptr<const Snapshot> snapshot;
    ros::Time stamp;
    bool changed = false;  ///< whether the stamp is newer than that of the moment before
    std::vector<Replacement> replacements;  ///< since the moment before
  };

  /// The newest snapshot with its stamp. The stamp is a new one where time has gone on, where an edit was
  /// made, or where it is asked for, to send again what has not changed.
  Moment advance(const Simulator& simulator, bool again);

  /// The stamp of the last moment.
  ros::Time stamp() const;

  /// Runs `load`, which replaces the world of `simulator`. The new world goes on at the stamp of the old.
  void replaceWorld(const Simulator& simulator, const Replacement& replacement,
                    const std::function<void()>& load);

 private:
  void follow(const Snapshot& snapshot);

  const bool wall_;
  mutable std::mutex mutex_;
  double elapsed_ = 0.0;  ///< physics time simulated since the node started, s
  double time_;           ///< physics time of the last snapshot, s
  std::uint64_t edits_;   ///< of the last snapshot
  ros::Time stamp_;       ///< of the last moment
  std::vector<Replacement> replacements_;  ///< since the last moment
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Timeline: the stamps of what the node publishes, on a line of time that never goes back.
//
// Physics time starts again at 0 whenever the world is replaced. The stamps go on: they advance with the
// physics, and by a nanosecond where an edit changes the world while time stands still, because tf drops
// a second transform with the stamp of the first.
#pragma once

#include "rigid_body_sim/simulator.h"

#include <ros/time.h>

#include <mutex>
#include <string>
#include <vector>

namespace rbs {

/// Thread-safe. Its lock is held for a few lines only, so no caller waits long.
class Timeline {
 public:
  /// With `wall` the stamps are those of the wall clock instead.
  explicit Timeline(bool wall);

  /// A replacement of the world by another.
  struct Replacement {
    std::string kind;  ///< kind of the event: "loaded", "reset", "undone" or "redone"
    std::string text;
  };

  /// What is published at one moment. Two moments have the same stamp only where nothing has changed.
  struct Moment {
    std::shared_ptr<const Snapshot> snapshot;
    ros::Time stamp;
    bool changed = false;                   ///< whether the stamp is newer than that of the moment before
    std::vector<Replacement> replacements;  ///< noted since the moment before
  };

  /// The newest snapshot with its stamp. The stamp is new where time has passed, where an edit was made, or
  /// where `again` requires it, to send unchanged data again. On the wall clock it is new ten times a second
  /// at least.
  Moment advance(const Simulator& simulator, bool again);

  /// The stamp of the last moment.
  ros::Time stamp() const;

  /// The next moment has a stamp of its own, so that all is sent again.
  void repeat();

  /// Notes for the next moment that the world was replaced.
  void note(Replacement replacement);

 private:
  const bool wall_;
  mutable std::mutex mutex_;
  double elapsed_ = 0.0;     ///< Snapshot::elapsed of the last moment, s
  std::uint64_t edits_ = 0;  ///< Snapshot::edits of the last moment
  ros::Time stamp_;          ///< of the last moment
  bool repeats_ = false;     ///< somebody has asked for a new stamp
  std::vector<Replacement> replacements_;
};

}  // namespace rbs

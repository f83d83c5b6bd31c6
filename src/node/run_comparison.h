// SPDX-License-Identifier: BSD-3-Clause
// How far the bodies of the live run are from those of a reference run at the same time.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

namespace rbs {

/// The reference run may be behind: the places of the live bodies are kept until it comes to their time. Where
/// they become too many, every second moment is dropped. Two runs are at the same time after the same number of
/// steps; after an edit of the live one, only a reference run that knows of it is compared. Thread-safe.
class RunComparison {
 public:
  struct Distances {
    double time = 0.0;              ///< physics time that was compared, s
    std::vector<double> of_bodies;  ///< m, in the order of the snapshots; not finite where a place is not
  };

  /// Keeps the places of the live bodies, once for each step.
  void addLive(const Snapshot& live);
  /// Whether the live run was kept after so many steps, with so many edits (Snapshot::edits).
  bool wants(std::uint64_t steps, std::uint64_t edits) const;
  /// Compares the bodies of the reference run at a time that wants() has asked for.
  void compare(const Snapshot& reference, std::uint64_t edits);
  /// What was compared last; null: nothing since the last edit, or since clear().
  std::shared_ptr<const Distances> newest() const;
  void clear();

 private:
  struct Moment {
    std::uint64_t steps;
    std::vector<Vec3> places;  ///< m
  };

  void thinOut();

  mutable std::mutex mutex_;
  std::uint64_t edits_ = 0;  ///< of the live run
  std::uint64_t next_ = 0;   ///< fewest steps of a live run that has not been kept yet
  std::deque<Moment> live_;  ///< that wait for the reference run, by steps
  std::shared_ptr<const Distances> newest_;
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// PhysicsTime: the physics time of a message that has only a stamp, from the statuses around it.
#pragma once

#include <optional>

namespace rbs {

/// Stamps never go back, but physics time begins again with the scene. Between two statuses both go on alike,
/// unless the scene was replaced, or the stamps are those of the wall clock: then only a message with the stamp
/// of a status is known to be of its time.
class PhysicsTime {
 public:
  /// A status: its stamp, s, and its physics time, s. Returns whether a run has begun since the one before:
  /// time went back or jumped ahead, or the simulator was started again.
  bool learn(double stamp, double time);

  /// When something of this stamp was, before or after a run began.
  struct When {
    double time;  ///< s
    bool is_of_this_run;
  };
  /// Nothing for a stamp that does not lie between the last two statuses, or whose time cannot be known.
  std::optional<When> of(double stamp) const;
  /// Whether the statuses have not yet come to this stamp.
  bool isAhead(double stamp) const { return !last_ || stamp > last_->stamp; }

 private:
  struct Status {
    double stamp, time;
    double offset() const { return stamp - time; }
  };

  std::optional<Status> before_, last_;
  bool is_steady_ = false;  ///< whether stamps go on like physics time, as far as is known
  bool has_begun_ = false;  ///< whether a run began between the two
};

}  // namespace rbs

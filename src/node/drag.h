// SPDX-License-Identifier: BSD-3-Clause
// A drag: what one mouse does to one body from the press to the release.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <variant>

#include "rigid_body_sim/world.h"

namespace rbs {

/// By the body itself: the point of the body under the mouse follows the mouse.
struct Pull {
  Vec3 p_B;           ///< the point, in B, m
  double click_slop;  ///< m; a point that has gone no further since the press was clicked, not dragged
};

/// By the gizmo: the body follows the gizmo's pose.
struct Carry {};

/// By the handle of a face: the face follows the handle and the opposite face stays.
struct Resize {
  Vec3 n_B;       ///< outward normal of the face, along an axis of B
  Vec3 n_W;       ///< the same in W, at the press
  Vec3 handle_W;  ///< the handle at the press, m
  double extent;  ///< of the body along n_B at the press, m
};

using Grip = std::variant<Pull, Carry, Resize>;

class Drag {
 public:
  /// Begins at the press. `handle` is the pose of the dragged marker; `marker` its name. After a click
  /// without a drag a paused body stays where it is, to the last bit.
  Drag(BodyId body, std::string marker, const Grip& grip, const Pose& handle);

  BodyId body() const { return body_; }
  const std::string& marker() const { return marker_; }

  /// The client says that it still drags, and where to when it says so.
  void hear(const std::optional<Pose>& handle);
  /// Whether the client has said nothing for so long (5 s) that it must be gone. An RViz that draws thousands
  /// of bodies in software may be silent for a second or two.
  bool silent() const;

  /// Has apply() lead the body anew, which somebody else has let go.
  void resume() { moved_ = true; }

  /// Whether apply() has something to do.
  bool due(const Snapshot& now) const;
  /// Leads the body to where the mouse is. A dynamic body of a running world is led by a spring (Pull) or
  /// as if kinematic (Carry); any other is simply put there. Throws InvalidInput.
  void apply(World& world, const Snapshot& now);
  /// Lets the body go: with its velocity after a Pull, at rest after a Carry. Throws InvalidInput.
  void release(World& world);

 private:
  using Clock = std::chrono::steady_clock;

  bool hasGone() const;
  void lead(World& world);
  void put(World& world, const Pose& pose) const;

  BodyId body_;
  std::string marker_;
  Grip grip_;
  Pose handle_, pressed_;  ///< of the marker now, and at the press
  Clock::time_point heard_ = Clock::now();
  bool moved_ = true;               ///< since the last apply()
  bool went_ = false;               ///< this is no click: the handle has gone somewhere since the press
  bool applied_to_paused_ = false;  ///< whether the world was paused then
  bool led_ = false;                ///< whether the world leads the body now
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// A drag: the user force, edit or kinematic target by which one mouse moves one body, from press to release.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "rigid_body_sim/world.h"

namespace rbs {

/// Drag of the body itself: the point of the body under the mouse follows the mouse.
struct Pull {
  Vec3 p_B;           ///< the point, in B, m
  double click_slop;  ///< m; a shorter motion since the press is a click, not a drag
};

/// Drag of the gizmo: the body follows the pose of the gizmo, as a kinematic target.
struct Carry {
  double jump;  ///< m; a gizmo may jump this far at the press: see Drag::hear()
};

/// Drag of the handle of a face: the face follows the handle, and the opposite face stays.
struct Resize {
  Vec3 n_B;       ///< outward normal of the face, along an axis of B
  Vec3 n_W;       ///< that normal in W, at the press
  Vec3 handle_W;  ///< the handle at the press, m
  double extent;  ///< extent of the body along n_B at the press, m
  double jump;    ///< m; as of Carry
};

using Grip = std::variant<Pull, Carry, Resize>;

class Drag {
 public:
  /// Begins at the press. `handle` is the pose of the dragged marker, `marker` its name. A click does not
  /// move a paused body, to the last bit.
  Drag(BodyId body, std::string marker, const Grip& grip, const Pose& handle);

  BodyId body() const { return body_; }
  const std::string& marker() const { return marker_; }

  /// The client is still dragging. `handle` is the new pose of the marker; empty: it has not moved. A gizmo or a handle jumps a
  /// little as it is pressed, with a mouse that stands still: RViz rounds the mouse to a pixel, and takes the point of the arrow
  /// or ring under it from a picture. So the first pose that comes is where a drag begins, if it is near enough to be such a
  /// jump, and what comes after it counts from there.
  void hear(const std::optional<Pose>& handle);
  /// Whether the client has sent nothing for 5 s, so that it must be gone. An RViz that renders thousands of
  /// bodies in software may be silent for a second or two.
  bool silent() const;

  /// Makes apply() set the user force again, after another drag of the body has released it.
  void resume() { moved_ = true; }

  /// Whether the marker has moved beyond a click, and the body has not yet followed.
  bool begins() const;
  void setBegun() { begun_ = true; }
  /// Whether apply() has something to do.
  bool due(const Snapshot& now) const;
  /// Moves the body to where the mouse is. A dynamic body of a running world is moved by a spring (Pull) or a
  /// kinematic target (Carry). Any other body gets the new pose at once; a dynamic one that is pulled stays outside of
  /// bodies that forces do not move. Throws InvalidInput.
  void apply(World& world, const Snapshot& now);
  /// The spring that pulls the body: its point on the body and its point at the mouse, in W, m. Empty: none does.
  std::optional<std::pair<Vec3, Vec3>> spring(const Snapshot& now) const;
  /// Releases the body: with its velocity after a Pull, at rest after a Carry. Throws InvalidInput.
  void release(World& world);

 private:
  using Clock = std::chrono::steady_clock;

  bool isJump(const Pose& handle) const;
  bool isBeyondClick() const;
  void applyUserForce(World& world);
  void setPose(World& world, const Snapshot& now, int which) const;

  BodyId body_;
  std::string marker_;
  Grip grip_;
  Pose handle_, pressed_;      ///< poses of the marker: now, and at the press
  std::optional<Pose> first_;  ///< from which the drag counts: see hear()
  Clock::time_point heard_ = Clock::now();
  bool moved_ = true;               ///< whether the marker has moved since the last apply()
  bool dragged_ = false;            ///< whether the marker has moved beyond a click since the press
  bool begun_ = false;              ///< whether the body has followed the marker
  bool applied_to_paused_ = false;  ///< whether the world was paused in the last apply()
  bool acting_ = false;             ///< whether a grab or hold of this drag acts on the body
};

}  // namespace rbs

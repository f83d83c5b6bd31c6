// SPDX-License-Identifier: BSD-3-Clause
// Interactive bodies: what a person does to bodies with the mouse in RViz.
//
// A click selects; a drag of the body pulls it; the selection has a gizmo to carry it, or handles to resize
// it; a right click opens a menu. All of it works while the world is paused, too.
//
// The mouse comes in by interactive markers, which any RViz has, and from the tool of our own, which reaches
// every body that is drawn and needs no marker.
#pragma once

#include <ros/ros.h>
#include <std_msgs/String.h>

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "click_targets.h"
#include "drag.h"
#include "marker_board.h"
#include "rigid_body_sim/simulator.h"

namespace rbs {

/// Serves ~interactive_bodies. Listens to ~select (the name of a body; "" selects none) and to
/// ~interactive_bodies/mouse: the same feedback as of interactive markers, of bodies by name. Tells the
/// selected body's name on ~selection (latched; "" for none), and what became of a click or a drag on
/// ~interactive_bodies/answer.
///
/// ROS hands over feedback while it holds the server's lock. It is only put into the inbox there, and
/// update() takes it out: so one thread alone uses all else.
class InteractiveBodies {
 public:
  explicit InteractiveBodies(Simulator& simulator);

  /// Does what was asked for since the last call, so call it as often as frames are drawn. The markers
  /// follow the bodies at most 15 times a second.
  void update(const Snapshot& snapshot);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  using FeedbackPtr = visualization_msgs::InteractiveMarkerFeedbackConstPtr;
  using Clock = std::chrono::steady_clock;

  /// What a mouse did, at a marker that its client shows or (from our own tool) at the body itself.
  struct MouseEvent {
    FeedbackPtr feedback;
    bool at_marker;
  };

  /// What came in since the last update().
  struct Inbox {
    std::vector<MouseEvent> mouse;
    std::optional<std::string> selection;  ///< name of a body, or ""
  };

  void forgetWorld(const Snapshot& snapshot);
  void handle(const MouseEvent& event, const Snapshot& snapshot);
  void press(const MouseEvent& event, const Snapshot& snapshot, int body);
  void followMouse(const MouseEvent& event);
  void runMenu(const Feedback& feedback, const Snapshot& snapshot, int body);
  void leadDrags(const Snapshot& snapshot);
  void lead(Drag& drag);
  void endDrag(std::map<std::string, Drag>::iterator drag);
  void select(BodyId id, const Vec3& focus_W);
  void selectNamed(const std::string& name, const Snapshot& snapshot);
  void showMarkers(const Snapshot& snapshot);
  void showSelection(const Snapshot& snapshot);
  void tellSelection(const Snapshot& snapshot);
  int bodyOf(const std::string& marker, const Snapshot& snapshot) const;
  void attempt(const char* what, const std::function<void(World&)>& command);
  void refuse(const std::string& text);
  void answer(const std::string& text);

  Simulator& simulator_;
  std::mutex inbox_mutex_;
  Inbox inbox_;
  MarkerBoard board_;
  ClickTargets targets_;
  std::uint64_t world_ = 0;            ///< that drags and the selection belong to
  std::map<std::string, Drag> drags_;  ///< by client: each has one mouse
  BodyId selected_;
  bool resizes_ = false;         ///< whether the selection has handles in place of the gizmo
  std::optional<Vec3> focus_W_;  ///< where the last click was; none: the view's target
  Clock::time_point shown_;
  std::string told_selection_;
  ros::Subscriber select_, mouse_;
  ros::Publisher selection_, answers_;
};

}  // namespace rbs

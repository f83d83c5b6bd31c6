// SPDX-License-Identifier: BSD-3-Clause
// Interactive bodies: what a person does to bodies with the mouse in RViz.
//
// A click selects; a drag of the body pulls it; the selection has a gizmo to carry it, or handles to resize
// it; a right click opens a menu. All of it works while the world is paused, too.
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

/// Serves ~interactive_bodies and listens to ~select (the name of a body; "" selects none).
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

  /// What came in since the last update().
  struct Inbox {
    std::vector<FeedbackPtr> feedback;
    std::optional<std::string> selection;  ///< name of a body, or ""
  };

  void forgetScene(const Snapshot& snapshot);
  void handle(const Feedback& feedback, const Snapshot& snapshot);
  void press(const Feedback& feedback, const Snapshot& snapshot, int body);
  void followMouse(const Feedback& feedback);
  void runMenu(const Feedback& feedback, const Snapshot& snapshot, int body);
  void leadDrags(const Snapshot& snapshot);
  void lead(Drag& drag);
  void endDrag(std::map<std::string, Drag>::iterator drag);
  void select(BodyId id, const Vec3& focus_W);
  void selectNamed(const std::string& name, const Snapshot& snapshot);
  void showMarkers(const Snapshot& snapshot);
  void showSelection(const Snapshot& snapshot);
  int bodyOf(const std::string& marker, const Snapshot& snapshot) const;
  void attempt(const char* what, const std::function<void(World&)>& command);

  Simulator& simulator_;
  std::mutex inbox_mutex_;
  Inbox inbox_;
  MarkerBoard board_;
  ClickTargets targets_;
  std::string scene_;
  std::map<std::string, Drag> drags_;  ///< by client: each has one mouse
  BodyId selected_;
  bool resizes_ = false;         ///< whether the selection has handles in place of the gizmo
  std::optional<Vec3> focus_W_;  ///< where the last click was; none: the view's target
  Clock::time_point shown_;
  ros::Subscriber select_;
};

}  // namespace rbs

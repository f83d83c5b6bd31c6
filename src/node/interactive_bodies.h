// SPDX-License-Identifier: BSD-3-Clause
// Interactive bodies: selects, drags, resizes and edits bodies by the mouse in RViz.
//
// A click selects; a drag of the body pulls it; the selection has a gizmo to carry it, or handles to resize
// it; a right click opens a menu, whose entries are for all that are selected with the body. All of it works while the world
// is paused, too.
//
// Mouse events come from interactive markers, which any RViz has, and from the Interact tool of this package,
// which reaches every drawn body and needs no marker.
#pragma once

#include <rigid_body_sim/BodyNames.h>
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

/// Serves ~interactive_bodies, and ~gizmo with the gizmo and the handles alone. Listens to ~select (the name of a body; "" selects none), to ~select_bodies (the
/// names of any number) and to ~interactive_bodies/mouse: feedback as from interactive markers, with the names
/// of bodies. Publishes the names of the selected bodies on ~selected_bodies (latched; in the order in which
/// they were selected), the springs that pull bodies on ~interactive_bodies/springs (a marker), the last selected
/// body on ~selection (latched; "" for none), and the result of a click or a
/// drag on ~interactive_bodies/answer. The last selected body has the gizmo.
///
/// ROS delivers feedback while it holds the server's lock. The callback only appends it to the inbox, and
/// update() handles it. So one thread uses everything but the inbox.
class InteractiveBodies {
 public:
  explicit InteractiveBodies(Simulator& simulator);

  /// Handles the events since the last call. Call it as often as frames are drawn. The markers follow the
  /// bodies at most 15 times a second.
  void update(const Snapshot& snapshot);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  using FeedbackPtr = visualization_msgs::InteractiveMarkerFeedbackConstPtr;
  using Clock = std::chrono::steady_clock;

  /// A mouse event, at a marker that its client shows, or (from our own tool) at the body itself.
  struct MouseEvent {
    FeedbackPtr feedback;
    bool at_marker;
  };

  /// Events since the last update().
  struct Inbox {
    std::vector<MouseEvent> mouse;
    std::optional<std::vector<std::string>> selection;  ///< names of bodies
  };

  void forgetWorld(const Snapshot& snapshot);
  void handle(const MouseEvent& event, const Snapshot& snapshot);
  void press(const MouseEvent& event, const Snapshot& snapshot, int body);
  void followMouse(const MouseEvent& event);
  void runMenu(const Feedback& feedback, const Snapshot& snapshot, int body);
  void applyDrags(const Snapshot& snapshot);
  void apply(Drag& drag);
  void endDrag(std::map<std::string, Drag>::iterator drag);
  void select(BodyId id, const Vec3& focus_W);
  void selectNamed(const std::vector<std::string>& names, const Snapshot& snapshot);
  void showMarkers(const Snapshot& snapshot);
  void showSelection(const Snapshot& snapshot);
  void publishSelection(const Snapshot& snapshot);
  void publishSprings(const Snapshot& snapshot);
  int bodyOf(const std::string& marker, const Snapshot& snapshot) const;
  BodyId selected() const { return selection_.empty() ? BodyId{} : selection_.back(); }
  bool attempt(const char* what, bool undoable, const std::function<std::string(World&)>& command);
  void refuse(const std::string& text);
  void answer(const std::string& text);

  Simulator& simulator_;
  std::mutex inbox_mutex_;
  Inbox inbox_;
  MarkerBoard board_;
  ClickTargets targets_;
  std::uint64_t world_ = 0;            ///< number of the world that drags and the selection belong to
  std::string scene_;                  ///< its name, as it was last seen
  std::map<std::string, Drag> drags_;  ///< by client: each client has one mouse
  std::vector<BodyId> selection_;      ///< the last one has the gizmo
  bool resizes_ = false;               ///< whether the selection has handles in place of the gizmo
  std::optional<Vec3> focus_W_;        ///< point of the last click; empty: the view's target
  Clock::time_point shown_;
  std::vector<std::string> published_selection_;
  ros::Subscriber select_, select_bodies_, mouse_;
  ros::Publisher selection_topic_, selected_bodies_, springs_, answers_;
  bool shows_springs_ = false;
};

}  // namespace rbs

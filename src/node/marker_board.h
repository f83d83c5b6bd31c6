// SPDX-License-Identifier: BSD-3-Clause
// The interactive markers that clients see, kept at what they should be with as few messages as possible.
#pragma once

#include <interactive_markers/interactive_marker_server.h>
#include <visualization_msgs/InteractiveMarker.h>

#include <map>
#include <set>
#include <string>

namespace rbs {

/// Shows, moves and erases interactive markers by name, on two servers: one has all of them, the other one only
/// what belongs to the selection, for viewers that reach the bodies themselves. Nothing is sent before publish(). A marker that a
/// client drags is left alone: replacing it would end the drag, and while it lasts the client leads.
class MarkerBoard {
 public:
  using Callback = interactive_markers::InteractiveMarkerServer::FeedbackCallback;

  /// Serves all on `topic`/update, /update_full and /feedback, and the selection's on `selection_topic`/update and so
  /// on. `callback` runs on a thread of ROS for every
  /// feedback message, with a lock of the server held: it must not wait for anyone who uses this board.
  MarkerBoard(const std::string& topic, const std::string& selection_topic, Callback callback);

  /// Shows this marker, in place of another look or pose of the same name.
  void show(const visualization_msgs::InteractiveMarker& marker);
  /// Moves a marker that is shown, if that can be seen.
  void move(const std::string& name, const geometry_msgs::Pose& pose);
  void erase(const std::string& name);
  bool shows(const std::string& name) const { return shown_.count(name) != 0; }

  /// A client drags this marker from now on. Several may.
  void grip(const std::string& name) { gripped_.insert(name); }
  /// The drag is over.
  void letGo(const std::string& name);
  /// Puts a marker that a client has moved back to where show() or move() had it. Otherwise the server sends
  /// on whatever pose came in.
  void putBack(const std::string& name);

  void publish();

 private:
  void setPose(const std::string& name, const geometry_msgs::Pose& pose);

  interactive_markers::InteractiveMarkerServer all_, of_selection_;
  Callback callback_;
  std::map<std::string, visualization_msgs::InteractiveMarker> shown_;
  std::multiset<std::string> gripped_;  ///< once for each client
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "interactive_bodies.h"

#include "body_markers.h"
#include "body_menu.h"
#include "convert.h"
#include "words.h"

#include <algorithm>

namespace rbs {
namespace {

using visualization_msgs::InteractiveMarkerFeedback;

bool isFinite(const Pose& pose) {
  return pose.p_WB.allFinite() && pose.q_WB.coeffs().allFinite();
}

std::optional<Vec3> hitPoint(const InteractiveMarkerFeedback& feedback) {
  const Vec3 p_W = fromMsg(feedback.mouse_point);
  if (!feedback.mouse_point_valid || !p_W.allFinite()) return std::nullopt;
  return p_W;
}

// Where a marker at X_WM is hit at p_W, seen from the marker, which sits on the body: p_B = R_WM^T (p_W -
// p_WM). Without a hit it is the centre.
Grip gripOf(const std::string& marker, const Pose& handle, const std::optional<Vec3>& hit_W,
            const BodyDescription& body) {
  if (marker == kGizmoName) return Carry{};
  if (const int face = handleFace(marker); face >= 0) {
    const Vec3 n_B = faceNormal(face);
    return Resize{n_B, handle.q_WB * n_B, handle.p_WB, fullExtents(body.shape)[face / 2]};
  }
  // RViz reads the point under the mouse from its depth image: a click alone moved a box of 0.4 m by 0.4 mm.
  constexpr double kSlop = 0.01, kMostSlop = 0.01;  // of the bounding radius; m
  return Pull{hit_W ? handle.q_WB.conjugate() * (*hit_W - handle.p_WB) : Vec3::Zero(),
              std::min(kSlop * boundingRadius(body.shape), kMostSlop)};
}

}  // namespace

InteractiveBodies::InteractiveBodies(Simulator& simulator)
    : simulator_(simulator),
      board_(ros::NodeHandle("~").resolveName("interactive_bodies"),
             [this](const FeedbackPtr& feedback) {
               std::lock_guard<std::mutex> lock(inbox_mutex_);
               inbox_.mouse.push_back({feedback, true});
             }),
      targets_(board_) {
  constexpr int kQueue = 100;
  ros::NodeHandle node("~");
  const boost::function<void(const std_msgs::StringConstPtr&)> ask =
      [this](const std_msgs::StringConstPtr& name) {
        std::lock_guard<std::mutex> lock(inbox_mutex_);
        inbox_.selection = name->data;
      };
  const boost::function<void(const FeedbackPtr&)> hear = [this](const FeedbackPtr& feedback) {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    inbox_.mouse.push_back({feedback, false});
  };
  select_ = node.subscribe<std_msgs::String>("select", kQueue, ask);
  mouse_ = node.subscribe<Feedback>("interactive_bodies/mouse", kQueue, hear);
  answers_ = node.advertise<std_msgs::String>("interactive_bodies/answer", kQueue);
  selection_ = node.advertise<std_msgs::String>("selection", 1, true);
  selection_.publish(std_msgs::String());
}

void InteractiveBodies::update(const Snapshot& snapshot) {
  Inbox news;
  {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    std::swap(news, inbox_);
  }
  if (snapshot.world != world_) forgetWorld(snapshot);
  for (const MouseEvent& event : news.mouse) handle(event, snapshot);
  if (news.selection) selectNamed(*news.selection, snapshot);
  applyDrags(snapshot);
  publishSelection(snapshot);
  showMarkers(snapshot);
}

// Every world numbers its bodies anew: an id of the last one would be of some other body. The selection goes
// on by its name, in the same scene.
void InteractiveBodies::forgetWorld(const Snapshot& snapshot) {
  const int again = snapshot.scene == scene_ ? snapshot.find(published_selection_) : -1;
  world_ = snapshot.world;
  scene_ = snapshot.scene;
  for (const auto& [client, drag] : drags_) board_.letGo(drag.marker());
  drags_.clear();
  selected_ = again >= 0 ? snapshot.states[again].id : BodyId{};
  resizes_ = false;
  focus_W_.reset();
}

void InteractiveBodies::handle(const MouseEvent& event, const Snapshot& snapshot) {
  const Feedback& feedback = *event.feedback;
  const int body = bodyOf(feedback.marker_name, snapshot);
  if (body < 0 && !event.at_marker && feedback.event_type == Feedback::MOUSE_DOWN)
    refuse(words("'", feedback.marker_name.substr(0, 64), "' is gone"));
  if (body < 0 || (event.at_marker && !board_.shows(feedback.marker_name)))
    return board_.erase(feedback.marker_name);
  if (!isFinite(fromMsg(feedback.pose))) return board_.putBack(feedback.marker_name);
  switch (feedback.event_type) {
    case Feedback::MOUSE_DOWN:
      return press(event, snapshot, body);
    case Feedback::POSE_UPDATE:
    case Feedback::KEEP_ALIVE:
    case Feedback::MOUSE_UP:
      return followMouse(event);
    case Feedback::MENU_SELECT:
      return runMenu(feedback, snapshot, body);
  }
}

void InteractiveBodies::press(const MouseEvent& event, const Snapshot& snapshot, int body) {
  const Feedback& feedback = *event.feedback;
  if (const auto old = drags_.find(feedback.client_id); old != drags_.end()) endDrag(old);
  const Pose handle = fromMsg(feedback.pose);
  const std::optional<Vec3> hit_W = hitPoint(feedback);
  const BodyDescription& description = (*snapshot.bodies)[body];
  const Grip grip = gripOf(feedback.marker_name, handle, hit_W, description);
  drags_.emplace(feedback.client_id,
                 Drag(description.id, event.at_marker ? feedback.marker_name : "", grip, handle));
  if (event.at_marker) board_.grip(feedback.marker_name);
  if (feedback.marker_name != description.name) return;
  select(description.id, hit_W.value_or(handle.p_WB));
  answer(words(description.name, ": ", describe(description)));
}

// RViz sends one more pose after the button is up; it belongs to no drag.
void InteractiveBodies::followMouse(const MouseEvent& event) {
  const Feedback& feedback = *event.feedback;
  const auto drag = drags_.find(feedback.client_id);
  if (drag == drags_.end() || drag->second.marker() != (event.at_marker ? feedback.marker_name : "")) {
    if (feedback.event_type == Feedback::POSE_UPDATE) board_.putBack(feedback.marker_name);
    return;
  }
  const bool is_still = feedback.event_type == Feedback::KEEP_ALIVE;
  drag->second.hear(is_still ? std::nullopt : std::make_optional(fromMsg(feedback.pose)));
  if (feedback.event_type == Feedback::MOUSE_UP) endDrag(drag);
}

void InteractiveBodies::runMenu(const Feedback& feedback, const Snapshot& snapshot, int body) {
  const BodyDescription& description = (*snapshot.bodies)[body];
  const std::optional<Vec3> hit_W = hitPoint(feedback);
  const Pose& pose = snapshot.states[body].pose;
  const auto action = static_cast<MenuAction>(feedback.menu_entry_id);
  const bool resized_before = resizes_ && selected_ == description.id;
  select(description.id, hit_W.value_or(pose.p_WB));
  if (action == MenuAction::Resize) {
    resizes_ = !resized_before;
    return;
  }
  attempt("run the menu entry", true, [&](World& world) {
    const std::string done =
        words(description.name, ": ", runMenuAction(world, action, description, pose, hit_W));
    answer(done);
    return done;
  });
}

void InteractiveBodies::applyDrags(const Snapshot& snapshot) {
  for (auto it = drags_.begin(); it != drags_.end();) {
    const auto drag = it++;
    if (drag->second.silent() || snapshot.find(drag->second.body()) < 0) {
      endDrag(drag);
    } else if (drag->second.due(snapshot)) {
      apply(drag->second);
    }
  }
}

// A drag is one edit: an undo goes back to before its first motion.
void InteractiveBodies::apply(Drag& drag) {
  const bool begins = drag.begins();
  const bool done = attempt("drag", begins, [&](World& world) {
    const std::shared_ptr<const Snapshot> now = simulator_.snapshot();
    drag.apply(world, *now);
    const int i = now->find(drag.body());
    return i < 0 ? std::string() : words("dragged '", (*now->bodies)[i].name, "'");
  });
  if (begins && done) drag.setBegun();
}

// The last motion of the mouse counts, even where the button was released before the next update().
void InteractiveBodies::endDrag(std::map<std::string, Drag>::iterator drag) {
  const std::shared_ptr<const Snapshot> now = simulator_.snapshot();
  if (now->find(drag->second.body()) >= 0) {
    if (drag->second.due(*now)) apply(drag->second);
    attempt("release", false, [&](World& world) { return drag->second.release(world), std::string(); });
  }
  board_.letGo(drag->second.marker());
  targets_.refresh();
  const BodyId body = drag->second.body();
  drags_.erase(drag);
  for (auto& [client, other] : drags_) {  // a body has one user force: the next drag of it takes over
    if (other.body() == body) other.resume();
  }
}

void InteractiveBodies::select(BodyId id, const Vec3& focus_W) {
  if (id != selected_) resizes_ = false;
  selected_ = id;
  focus_W_ = focus_W;
}

void InteractiveBodies::selectNamed(const std::string& name, const Snapshot& snapshot) {
  const int body = snapshot.find(name);
  if (body >= 0) {
    select(snapshot.states[body].id, snapshot.states[body].pose.p_WB);
  } else {
    selected_ = BodyId{};
    if (!name.empty()) refuse(words("cannot select '", name.substr(0, 64), "': no such body"));
  }
}

void InteractiveBodies::publishSelection(const Snapshot& snapshot) {
  const int i = snapshot.find(selected_);
  std_msgs::String name;
  if (i >= 0) name.data = (*snapshot.bodies)[i].name;
  if (name.data == published_selection_) return;
  published_selection_ = name.data;
  selection_.publish(name);
}

void InteractiveBodies::showMarkers(const Snapshot& snapshot) {
  constexpr std::chrono::milliseconds kPeriod(66);
  if (Clock::now() - shown_ < kPeriod) return;
  shown_ = Clock::now();
  targets_.update(snapshot, focus_W_.value_or(snapshot.view.target), selected_);
  showSelection(snapshot);
  board_.publish();
}

void InteractiveBodies::showSelection(const Snapshot& snapshot) {
  const int i = snapshot.find(selected_);
  if (i < 0) {  // the body is deleted, and a body of another world may get its id
    selected_ = BodyId{};
    resizes_ = false;
  }
  const bool has_faces = i >= 0 && !std::holds_alternative<Plane>((*snapshot.bodies)[i].shape);
  const bool has_handles = resizes_ && has_faces;
  if (i < 0 || has_handles) board_.erase(kGizmoName);
  for (int face = 0; face < kFaces; ++face) {
    if (has_handles) {
      board_.show(faceHandle((*snapshot.bodies)[i], snapshot.states[i].pose, face));
    } else {
      board_.erase(handleName(face));
    }
  }
  if (i >= 0 && !has_handles) {
    board_.show(gizmo((*snapshot.bodies)[i], snapshot.states[i].pose, snapshot.view));
  }
}

int InteractiveBodies::bodyOf(const std::string& marker, const Snapshot& snapshot) const {
  const bool is_of_selection = marker == kGizmoName || handleFace(marker) >= 0;
  return is_of_selection ? snapshot.find(selected_) : snapshot.find(marker);
}

// Does nothing where another world has replaced the one that the mouse was used on. False where it was refused.
bool InteractiveBodies::attempt(const char* what, bool undoable,
                                const std::function<std::string(World&)>& command) {
  const auto run = [&](World& world) {
    return simulator_.snapshot()->world == world_ ? command(world) : std::string();
  };
  try {
    undoable ? void(simulator_.apply(run)) : simulator_.edit(run);
    return true;
  } catch (const InvalidInput& error) {
    refuse(words("cannot ", what, ": ", error.what()));
    return false;
  }
}

void InteractiveBodies::refuse(const std::string& text) {
  ROS_WARN_THROTTLE_NAMED(1.0, "interactive_bodies", "%s", text.c_str());
  answer(text);
}

void InteractiveBodies::answer(const std::string& text) {
  std_msgs::String message;
  message.data = text;
  answers_.publish(message);
}

}  // namespace rbs

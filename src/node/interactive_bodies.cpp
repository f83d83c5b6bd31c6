// SPDX-License-Identifier: BSD-3-Clause
#include "interactive_bodies.h"

#include "body_markers.h"
#include "body_menu.h"
#include "convert.h"
#include "words.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace rbs {
namespace {

using visualization_msgs::InteractiveMarkerFeedback;

std::optional<Vec3> hitPoint(const InteractiveMarkerFeedback& feedback) {
  const Vec3 p_W = fromMsg(feedback.mouse_point);
  if (!feedback.mouse_point_valid || !p_W.allFinite()) return std::nullopt;
  return p_W;
}

// Where a marker at X_WM is hit at p_W, seen from the marker, which sits on the body: p_B = R_WM^T (p_W -
// p_WM). Without a hit it is the centre.
Grip gripOf(const std::string& marker, const Pose& handle, const std::optional<Vec3>& hit_W,
            const BodyDescription& body) {
  constexpr double kJump = 0.1, kMostJump = 0.02;  // of the length of what is moved; m
  if (marker == kGizmoName) return Carry{std::min(kJump * boundingRadius(body.shape), kMostJump)};
  if (const int face = handleFace(marker); face >= 0) {
    const Vec3 n_B = faceNormal(face);
    const double extent = fullExtents(body.shape)[face / 2];
    return Resize{n_B, handle.q_WB * n_B, handle.p_WB, extent, std::min(kJump * extent, kMostJump)};
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
             ros::NodeHandle("~").resolveName("gizmo"),
             [this](const FeedbackPtr& feedback) {
               std::lock_guard<std::mutex> lock(inbox_mutex_);
               inbox_.mouse.push_back({feedback, true});
             }),
      targets_(board_) {
  constexpr int kQueue = 100;
  ros::NodeHandle node("~");
  const auto ask = [this](std::vector<std::string> names) {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    inbox_.selection = std::move(names);
  };
  const boost::function<void(const std_msgs::StringConstPtr&)> ask_one =
      [ask](const std_msgs::StringConstPtr& name) {
        ask(name->data.empty() ? std::vector<std::string>() : std::vector<std::string>{name->data});
      };
  const boost::function<void(const rigid_body_sim::BodyNamesConstPtr&)> ask_many =
      [ask](const rigid_body_sim::BodyNamesConstPtr& message) { ask(message->names); };
  const boost::function<void(const FeedbackPtr&)> hear = [this](const FeedbackPtr& feedback) {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    inbox_.mouse.push_back({feedback, false});
  };
  select_ = node.subscribe<std_msgs::String>("select", kQueue, ask_one);
  select_bodies_ = node.subscribe<rigid_body_sim::BodyNames>("select_bodies", kQueue, ask_many);
  mouse_ = node.subscribe<Feedback>("interactive_bodies/mouse", kQueue, hear);
  answers_ = node.advertise<std_msgs::String>("interactive_bodies/answer", kQueue);
  springs_ = node.advertise<visualization_msgs::Marker>("interactive_bodies/springs", kQueue);
  selection_topic_ = node.advertise<std_msgs::String>("selection", 1, true);
  selection_topic_.publish(std_msgs::String());
  selected_bodies_ = node.advertise<rigid_body_sim::BodyNames>("selected_bodies", 1, true);
  selected_bodies_.publish(rigid_body_sim::BodyNames());
}

void InteractiveBodies::update(const Snapshot& snapshot) {
  Inbox news;
  {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    std::swap(news, inbox_);
  }
  if (snapshot.world != world_) forgetWorld(snapshot);
  scene_ = snapshot.scene;
  for (const MouseEvent& event : news.mouse) handle(event, snapshot);
  if (news.selection) selectNamed(*news.selection, snapshot);
  applyDrags(snapshot);
  publishSelection(snapshot);
  publishSprings(snapshot);
  showMarkers(snapshot);
}

// Every world numbers its bodies anew: an id of the last one may be of some other body. The selection goes on in the same
// scene, by its name; by its id where an undo has taken the name away, which keeps ids.
void InteractiveBodies::forgetWorld(const Snapshot& snapshot) {
  const std::vector<BodyId> before = std::exchange(selection_, {});
  for (std::size_t k = 0; k < published_selection_.size() && snapshot.scene == scene_; ++k) {
    int again = snapshot.find(published_selection_[k]);
    if (again < 0 && before.size() == published_selection_.size()) again = snapshot.find(before[k]);
    if (again >= 0) selection_.push_back(snapshot.states[again].id);
  }
  world_ = snapshot.world;
  for (const auto& [client, drag] : drags_) board_.letGo(drag.marker());
  drags_.clear();
  resizes_ = false;
  focus_W_.reset();
}

void InteractiveBodies::handle(const MouseEvent& event, const Snapshot& snapshot) {
  const Feedback& feedback = *event.feedback;
  const bool begins =
      feedback.event_type == Feedback::MOUSE_DOWN || feedback.event_type == Feedback::MENU_SELECT;
  // A drag of the body itself goes on whatever the body is called meanwhile.
  if (!event.at_marker && !begins && drags_.count(feedback.client_id) != 0) return followMouse(event);
  const int body = bodyOf(feedback.marker_name, snapshot);
  if (body < 0 && !event.at_marker && begins)
    refuse(words("'", feedback.marker_name.substr(0, 64), "' is gone"));
  if (body < 0 || (event.at_marker && !board_.shows(feedback.marker_name)))
    return board_.erase(feedback.marker_name);
  if (!isFinite(fromMsg(feedback.pose)) && feedback.event_type != Feedback::MOUSE_UP)
    return board_.putBack(feedback.marker_name);
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
  const Pose pose = fromMsg(feedback.pose);
  const bool is_still = feedback.event_type == Feedback::KEEP_ALIVE || !isFinite(pose);
  drag->second.hear(is_still ? std::nullopt : std::make_optional(pose));
  if (feedback.event_type == Feedback::MOUSE_UP) endDrag(drag);
}

void InteractiveBodies::runMenu(const Feedback& feedback, const Snapshot& snapshot, int body) {
  const BodyDescription& description = (*snapshot.bodies)[body];
  const std::optional<Vec3> hit_W = hitPoint(feedback);
  const auto action = static_cast<MenuAction>(feedback.menu_entry_id % kMenuActions);
  const std::uint32_t mark = feedback.menu_entry_id / kMenuActions;
  if (mark != 0 && mark != menuScope(selection_).mark)
    return refuse("the selection has changed since the menu opened: nothing is done");
  const bool resized_before = resizes_ && selected() == description.id;
  select(description.id, hit_W.value_or(snapshot.states[body].pose.p_WB));
  if (action == MenuAction::Resize) {
    resizes_ = !resized_before;
    return;
  }
  std::vector<BodyDescription> bodies;  // this one comes last
  for (const BodyId id : mark != 0 ? selection_ : std::vector<BodyId>{description.id})
    if (const int i = snapshot.find(id); i >= 0) bodies.push_back((*snapshot.bodies)[i]);
  attempt("run the menu entry", true, [&](World& world) {
    const std::string done = runMenuAction(world, action, bodies, hit_W);
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

// One of several that are selected comes last; any other body is selected alone.
void InteractiveBodies::select(BodyId id, const Vec3& focus_W) {
  if (id != selected()) resizes_ = false;
  const auto place = std::find(selection_.begin(), selection_.end(), id);
  if (place == selection_.end()) {
    selection_ = {id};
  } else {
    std::rotate(place, place + 1, selection_.end());
  }
  focus_W_ = focus_W;
}

void InteractiveBodies::selectNamed(const std::vector<std::string>& names, const Snapshot& snapshot) {
  std::unordered_map<std::string, int> known;
  for (std::size_t i = 0; i < snapshot.bodies->size(); ++i) known.emplace((*snapshot.bodies)[i].name, int(i));
  const BodyId before = selected();
  std::unordered_set<int> taken;
  std::vector<std::string> unknown;
  selection_.clear();
  for (const std::string& name : names) {
    const auto it = known.find(name);
    if (it == known.end()) {
      unknown.push_back(name);
    } else if (taken.insert(it->second).second) {
      selection_.push_back(snapshot.states[it->second].id);
    }
  }
  if (selected() != before) resizes_ = false;
  if (const int last = snapshot.find(selected()); last >= 0) focus_W_ = snapshot.states[last].pose.p_WB;
  if (unknown.empty()) return;
  const std::string more = unknown.size() > 1 ? words(" and ", unknown.size() - 1, " more") : "";
  refuse(words("cannot select '", unknown.front().substr(0, 64), "'", more, ": no such body"));
}

// What has been deleted is selected no longer.
void InteractiveBodies::publishSelection(const Snapshot& snapshot) {
  rigid_body_sim::BodyNames selected;
  std::vector<BodyId> there;
  for (const BodyId id : selection_) {
    const int i = snapshot.find(id);
    if (i < 0) continue;
    there.push_back(id);
    selected.names.push_back((*snapshot.bodies)[i].name);
  }
  if (there != selection_) {
    if (there.empty() || there.back() != selection_.back()) resizes_ = false;
    selection_ = std::move(there);
  }
  if (selected.names == published_selection_) return;
  std_msgs::String last;
  if (!selected.names.empty()) last.data = selected.names.back();
  const bool same_last = !published_selection_.empty() && published_selection_.back() == last.data;
  published_selection_ = selected.names;
  selected_bodies_.publish(selected);
  if (!same_last) selection_topic_.publish(last);
}

// A line for each, and an end where there are none any more.
void InteractiveBodies::publishSprings(const Snapshot& snapshot) {
  visualization_msgs::Marker lines;
  for (const auto& [client, drag] : drags_) {
    const auto spring = drag.spring(snapshot);
    if (!spring) continue;
    lines.points.push_back(toPoint(spring->first));
    lines.points.push_back(toPoint(spring->second));
  }
  if (lines.points.empty() && !shows_springs_) return;
  shows_springs_ = !lines.points.empty();
  constexpr double kWidth = 0.004;  // of the distance of the view
  lines.header.frame_id = worldFrame();
  lines.ns = "springs";
  lines.type = visualization_msgs::Marker::LINE_LIST;
  lines.action = shows_springs_ ? visualization_msgs::Marker::ADD : visualization_msgs::Marker::DELETE;
  lines.pose.orientation.w = 1.0;
  lines.scale.x = kWidth * (snapshot.view.eye - snapshot.view.target).norm();
  lines.color = toMsg(Color{0.95f, 0.6f, 0.1f, 1.0f});
  springs_.publish(lines);
}

void InteractiveBodies::showMarkers(const Snapshot& snapshot) {
  constexpr std::chrono::milliseconds kPeriod(66);
  if (Clock::now() - shown_ < kPeriod) return;
  shown_ = Clock::now();
  targets_.update(snapshot, focus_W_.value_or(snapshot.view.target), selection_);
  showSelection(snapshot);
  board_.publish();
}

void InteractiveBodies::showSelection(const Snapshot& snapshot) {
  const int i = snapshot.find(selected());
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
  return isOfSelection(marker) ? snapshot.find(selected()) : snapshot.find(marker);
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

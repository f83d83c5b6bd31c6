#include "interactive_bodies.h"

#include "body_markers.h"
#include "body_menu.h"
#include "convert.h"

namespace rbs {
namespace {

using visualization_msgs::InteractiveMarkerFeedback;

bool isFinite(const Pose& pose) { return pose.p_WB.allFinite() && pose.q_WB.coeffs().allFinite(); }

std::optional<Vec3> hitPoint(const InteractiveMarkerFeedback& feedback) {
  const Vec3 p_W = fromMsg(feedback.mouse_point);
  if (!feedback.mouse_point_valid || !p_W.allFinite()) return std::nullopt;
  return p_W;
}

// Where a marker at X_WM is hit at p_W, seen from the marker, which sits on the body: p_B = R_WM^T (p_W - p_WM).
// Without a hit it is the centre.
Grip gripOf(const std::string& marker, const Pose& handle, const std::optional<Vec3>& hit_W,
            const BodyDescription& body) {
  if (marker == kGizmoName) return Carry{};
  if (const int face = handleFace(marker); face >= 0) {
    const Vec3 n_B = faceNormal(face);
    return Resize{n_B, handle.q_WB * n_B, handle.p_WB, fullExtents(body.shape)[face / 2]};
  }
  return Pull{hit_W ? handle.q_WB.conjugate() * (*hit_W - handle.p_WB) : Vec3::Zero()};
}

}  // namespace

InteractiveBodies::InteractiveBodies(Simulator& simulator)
    : simulator_(simulator),
      board_(ros::NodeHandle("~").resolveName("interactive_bodies"),
             [this](const FeedbackPtr& feedback) {
               std::lock_guard<std::mutex> lock(box_mutex_);
               box_.feedback.push_back(feedback);
             }),
      targets_(board_) {
  constexpr int kQueue = 10;
  const boost::function<void(const std_msgs::StringConstPtr&)> ask = [this](const std_msgs::StringConstPtr& name) {
    std::lock_guard<std::mutex> lock(box_mutex_);
    box_.selection = name->data;
  };
  select_ = ros::NodeHandle("~").subscribe<std_msgs::String>("select", kQueue, ask);
}

void InteractiveBodies::update(const Snapshot& snapshot) {
  const Box box = empty();
  for (const FeedbackPtr& feedback : box.feedback) handle(*feedback, snapshot);
  if (box.selection) {
    const int body = snapshot.find(*box.selection);
    select(body < 0 ? BodyId{} : snapshot.states[body].id, ...);
  }
  leadDrags(snapshot);
  constexpr std::chrono::milliseconds kPeriod(66);
  if (Clock::now() - shown_ < kPeriod) return;
  shown_ = Clock::now();
  showMarkers(snapshot);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "body_mouse.h"

#include "mouse_ray.h"

#include <OgreCamera.h>
#include <OgreRay.h>
#include <OgreViewport.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/render_panel.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/view_controller.h>
#include <rviz/viewport_mouse_event.h>

#include <QPointer>

#include <cmath>
#include <tuple>

namespace rbs {
namespace {

geometry_msgs::Point pointMsg(const Ogre::Vector3& p) {
  geometry_msgs::Point point;
  point.x = p.x, point.y = p.y, point.z = p.z;
  return point;
}

// By how much farther from the eye the mouse moves what it drags.
float fartherBy(const rviz::ViewportMouseEvent& event) {
  constexpr float kNotch = 120.0f, kByNotch = 0.1f, kByPixel = 0.005f;  // shares of the distance
  if (event.type == QEvent::Wheel) return std::exp(kByNotch * static_cast<float>(event.wheel_delta) / kNotch);
  return (event.modifiers & Qt::ShiftModifier)
             ? std::exp(kByPixel * static_cast<float>(event.last_y - event.y))
             : 1.0f;
}

}  // namespace

BodyMouse::BodyMouse(rviz::DisplayContext& context) : context_(context) {
  constexpr int kPeriod = 250;  // ms, as of RViz's interactive markers
  QObject::connect(&still_there_, &QTimer::timeout, &still_there_, [this] {
    if (drag_) send(drag_->target, Feedback::KEEP_ALIVE);
  });
  still_there_.setInterval(kPeriod);
}

void BodyMouse::aim(const std::shared_ptr<SimulatorBodies>& simulator,
                    const rigid_body_sim::BodyDescription& body, const Ogre::Vector3& position,
                    const Ogre::Quaternion& orientation) {
  target_ = {simulator, body, position, orientation};
}

void BodyMouse::handleMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.type == QEvent::FocusIn) return showHints();
  if (event.type == QEvent::FocusOut) return letGo();
  if (event.leftDown()) return press(event);
  if (drags() && (event.type == QEvent::MouseMove || event.type == QEvent::Wheel)) return move(event);
  if (event.leftUp()) return letGo();
  if (event.rightUp() && event.buttons_down == Qt::NoButton) return showMenu(event);
  const bool is_for_menu = event.right();
  if (!drags() && !is_for_menu && event.panel->getViewController())
    event.panel->getViewController()->handleMouseEvent(event);
  showHints();  // over the hints of the view
}

void BodyMouse::showHints() {
  context_.setStatus(
      "<b>Left-Click:</b> Select. <b>Left-Drag:</b> Pull. <b>Shift / Wheel in a drag:</b> Nearer or farther. "
      "<b>Right-Click:</b> Menu.");
}

void BodyMouse::withHitPoint(const rviz::ViewportMouseEvent& event, const WithHit& then) {
  const unsigned number = ++asked_;
  query_.reset();
  Ogre::Vector3 point;
  const bool is_there = context_.getSelectionManager()->get3DPoint(event.viewport, event.x, event.y, point);
  const Hit hit = is_there ? Hit(point) : std::nullopt;
  if (!isSeeThrough(target_.body)) return then(target_, hit);
  query_ = Query{target_, hit, then};
  askBodyUnder(event, context_, *target_.simulator, [this, number](const SimulatorBodies::Answer& said) {
    if (number == asked_) answer(said);
  });
}

void BodyMouse::answer(const SimulatorBodies::Answer& answer) {
  if (!query_) return;
  Query query = std::move(*query_);
  query_.reset();
  if (!answer.came) {
    press_.reset();
    context_.setStatus("The simulator has not said in time what is behind this wall.");
    return;
  }
  Ogre::Vector3 p_FW;
  Ogre::Quaternion q_FW;
  const std::string& frame = query.seen.simulator->frame();
  if (!answer.met || !context_.getFrameManager()->getTransform(frame, ros::Time(), p_FW, q_FW))
    return query.then(query.seen, query.hit);
  const auto& [p, q] = std::tie(answer.met->body.pose.position, answer.met->body.pose.orientation);
  const geometry_msgs::Point& point = answer.met->point;
  const Target behind{query.seen.simulator, answer.met->body.description,
                      q_FW * Ogre::Vector3(p.x, p.y, p.z) + p_FW,
                      q_FW * Ogre::Quaternion(q.w, q.x, q.y, q.z)};
  query.then(behind, q_FW * Ogre::Vector3(point.x, point.y, point.z) + p_FW);
}

void askBodyUnder(const rviz::ViewportMouseEvent& event, rviz::DisplayContext& context,
                  SimulatorBodies& simulator, const SimulatorBodies::WithAnswer& then) {
  Ogre::Vector3 p_FW;
  Ogre::Quaternion q_FW;
  if (!context.getFrameManager()->getTransform(simulator.frame(), ros::Time(), p_FW, q_FW))
    return then({true, std::nullopt});
  const Ogre::Ray ray = mouseRay(event);
  const Ogre::Vector3 direction = q_FW.Inverse() * ray.getDirection();
  geometry_msgs::Vector3 direction_W;
  direction_W.x = direction.x, direction_W.y = direction.y, direction_W.z = direction.z;
  simulator.meet(pointMsg(q_FW.Inverse() * (ray.getOrigin() - p_FW)), direction_W, then);
}

void BodyMouse::press(rviz::ViewportMouseEvent& event) {
  press_ = Press{mouseRay(event), event.viewport->getCamera()->getRealDirection(), std::nullopt};
  withHitPoint(event, [this](const Target& target, const Hit& hit) {
    const Press press = *press_;
    press_.reset();
    begin(press, target, hit.value_or(target.position));
  });
}

void BodyMouse::begin(const Press& press, const Target& target, const Ogre::Vector3& hit) {
  const Ogre::Plane plane(press.view, hit);
  // Where the ray meets the plane, and not the hit, which the depth buffer has rounded: a mouse that does not
  // move then moves the body by nothing.
  const auto [meets, distance] = press.ray.intersects(plane);
  drag_ = Drag{target, plane, meets ? press.ray.getPoint(distance) : hit, Ogre::Vector3::ZERO};
  send(target, Feedback::MOUSE_DOWN, hit);
  still_there_.start();
  if (press.moved_to) moveTo(*press.moved_to);
  if (press.released) letGo();
}

void BodyMouse::move(const rviz::ViewportMouseEvent& event) {
  if (!drag_) {
    press_->moved_to = mouseRay(event);
    return;
  }
  const Ogre::Vector3 eye = event.viewport->getCamera()->getDerivedPosition();
  drag_->plane.d += (fartherBy(event) - 1.0f) * drag_->plane.getDistance(eye);
  moveTo(mouseRay(event));
}

// A point behind the eye is under no pixel.
void BodyMouse::moveTo(const Ogre::Ray& ray) {
  const auto [meets, distance] = ray.intersects(drag_->plane);
  if (!meets) return;
  drag_->moved_by = ray.getPoint(distance) - drag_->grip;
  send(drag_->target, Feedback::POSE_UPDATE);
  still_there_.start();
}

void BodyMouse::letGo() {
  if (press_) press_->released = true;
  if (!drag_) return;
  send(drag_->target, Feedback::MOUSE_UP);
  still_there_.stop();
  drag_.reset();
}

void BodyMouse::cancel() {
  query_.reset();
  press_.reset();
  letGo();
}

void BodyMouse::showMenu(rviz::ViewportMouseEvent& event) {
  press_.reset();
  withHitPoint(
      event, [this, panel = QPointer<rviz::RenderPanel>(event.panel)](const Target& target, const Hit& hit) {
        if (panel.isNull() || panel->contextMenuVisible()) return;
        fillMenu(target, hit);
        panel->showContextMenu(menu_);
      });
}

void BodyMouse::fillMenu(const Target& target, const Hit& hit) {
  menu_.reset(new QMenu);
  const MenuScope scope = target.simulator->menuScope(target.body.name);
  for (const auto& [entry, title] : menuTitles(target.body.shape, target.body.kind, scope)) {
    menu_->addAction(QString::fromStdString(title),
                     [this, target, hit, id = entry] { send(target, Feedback::MENU_SELECT, hit, id); });
  }
}

// The simulator thinks in the frame of its world, which need not be RViz's fixed frame.
void BodyMouse::send(const Target& target, std::uint8_t event_type, const Hit& hit, std::uint32_t entry) {
  Ogre::Vector3 p_FW;
  Ogre::Quaternion q_FW;
  if (!context_.getFrameManager()->getTransform(target.simulator->frame(), ros::Time(), p_FW, q_FW)) return;
  const Ogre::Quaternion q_WF = q_FW.Inverse();
  const Ogre::Vector3 moved_by = drag_ ? drag_->moved_by : Ogre::Vector3::ZERO;
  const Ogre::Quaternion q_WB = q_WF * target.orientation;
  Feedback feedback;
  feedback.header.frame_id = target.simulator->frame();
  feedback.client_id = ros::this_node::getName() + "/mouse";
  feedback.marker_name = target.body.name;
  feedback.event_type = event_type;
  feedback.menu_entry_id = entry;
  feedback.pose.position = pointMsg(q_WF * (target.position + moved_by - p_FW));
  feedback.pose.orientation.w = q_WB.w;
  feedback.pose.orientation.x = q_WB.x;
  feedback.pose.orientation.y = q_WB.y;
  feedback.pose.orientation.z = q_WB.z;
  feedback.mouse_point_valid = hit.has_value();
  if (hit) feedback.mouse_point = pointMsg(q_WF * (*hit - p_FW));
  target.simulator->send(feedback);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "spawn_tool.h"

#include "mouse_ray.h"
#include "simulation_panel.h"

#include <OgreCamera.h>
#include <OgrePlane.h>
#include <OgreRay.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <rviz/display_context.h>
#include <rviz/load_resource.h>
#include <rviz/render_panel.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/view_manager.h>
#include <rviz/viewport_mouse_event.h>
#include <rviz/window_manager_interface.h>
#include <pluginlib/class_list_macros.hpp>

#include <QApplication>
#include <QMenu>

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

constexpr float kSmallest = 1e-3f, kLargest = 1e3f;  // m

struct GhostShape {
  const char* name;
  rviz::Shape::Type type;
};
constexpr GhostShape kShapes[] = {{"box", rviz::Shape::Cube},
                                  {"sphere", rviz::Shape::Sphere},
                                  {"cylinder", rviz::Shape::Cylinder},
                                  {"cone", rviz::Shape::Cone}};

std::optional<Ogre::Vector3> meet(const Ogre::Ray& ray, const Ogre::Plane& plane) {
  const auto [meets, distance] = ray.intersects(plane);
  return meets ? std::make_optional(ray.getPoint(distance)) : std::nullopt;
}

}  // namespace

SpawnTool::SpawnTool() {
  shortcut_key_ = 'b';
  rviz::Property* const container = getPropertyContainer();
  shape_ = new rviz::EnumProperty("Shape", "box", "Shape of the new bodies.", container);
  for (std::size_t k = 0; k < std::size(kShapes); ++k)
    shape_->addOption(kShapes[k].name, static_cast<int>(k));
  size_ = new rviz::FloatProperty("Size", 0.5f, "Full extents, m.", container);
  size_->setMin(kSmallest);
  size_->setMax(kLargest);
  density_ = new rviz::FloatProperty("Density", 1000.0f, "kg/m³.", container);
  density_->setMin(1e-6f);
  friction_ = new rviz::FloatProperty("Friction", 0.6f, "Coulomb coefficient.", container);
  friction_->setMin(0.0f);
  restitution_ = new rviz::FloatProperty("Restitution", 0.0f, "0: no rebound, 1: elastic.", container);
  restitution_->setMin(0.0f);
  restitution_->setMax(1.0f);
  is_static_ = new rviz::BoolProperty("Static", false, "The new bodies never move.", container);
  speed_ = new rviz::FloatProperty("Speed", 5.0f, "Of a throw, m/s for each metre that the mouse is dragged.",
                                   container);
  speed_->setMin(0.0f);
  connect(shape_, &rviz::Property::changed, this, [this] { showGhost(); });
  connect(size_, &rviz::Property::changed, this, [this] { showGhost(); });
}

SpawnTool::~SpawnTool() = default;

void SpawnTool::onInitialize() {
  setName("Add body");
  setIcon(rviz::loadPixmap("package://rigid_body_sim/icons/classes/Spawn.svg"));
  setDescription("Adds bodies where the mouse is");
}

void SpawnTool::activate() {
  setStatus(
      "<b>Left-Click:</b> Add. <b>Left-Drag:</b> Throw. <b>Wheel:</b> Size. <b>Right-Click:</b> Shape. "
      "<b>Middle:</b> Move the view.");
}

void SpawnTool::deactivate() {
  ghost_.reset();
  arrow_.reset();
  position_.reset();
  drags_ = false;
}

Ogre::Vector3 SpawnTool::extents() const {
  return Ogre::Vector3(size_->getFloat());
}

// Ogre's cylinder and cone stand along y.
void SpawnTool::showGhost() {
  if (!position_) return ghost_.reset();
  const GhostShape& shape = kShapes[shape_->getOptionInt()];
  if (!ghost_ || ghost_->getType() != shape.type)
    ghost_ = std::make_unique<rviz::Shape>(shape.type, scene_manager_);
  const bool stands = shape.type == rviz::Shape::Cylinder || shape.type == rviz::Shape::Cone;
  ghost_->setOrientation(stands ? Ogre::Quaternion(Ogre::Degree(90), Ogre::Vector3::UNIT_X)
                                : Ogre::Quaternion::IDENTITY);
  ghost_->setScale(extents());
  ghost_->setPosition(*position_);
  ghost_->setColor(0.2f, 0.5f, 0.8f, 0.5f);
}

// The ghost itself is not there.
std::optional<Ogre::Vector3> SpawnTool::surfaceUnder(const rviz::ViewportMouseEvent& event) {
  if (ghost_) ghost_->getRootNode()->setVisible(false);
  Ogre::Vector3 point;
  const bool is_hit = context_->getSelectionManager()->get3DPoint(event.viewport, event.x, event.y, point);
  if (ghost_) ghost_->getRootNode()->setVisible(true);
  const bool is_finite = std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
  if (is_hit && is_finite) return point;
  return meet(mouseRay(event), Ogre::Plane(Ogre::Vector3::UNIT_Z, 0.0f));
}

void SpawnTool::place(const rviz::ViewportMouseEvent& event) {
  constexpr float kClear = 0.505f;  // of the height: just above the surface
  position_ = surfaceUnder(event);
  if (position_) position_->z += kClear * extents().z;
  showGhost();
}

// In the plane of the view, through the ghost.
void SpawnTool::aim(const rviz::ViewportMouseEvent& event) {
  const Ogre::Plane plane(event.viewport->getCamera()->getRealDirection(), *position_);
  const std::optional<Ogre::Vector3> end = meet(mouseRay(event), plane);
  if (!end) return;
  const Ogre::Vector3 drag = *end - *position_;
  const bool is_click = drag.length() < 0.1f * extents().z;
  velocity_ = is_click ? Ogre::Vector3::ZERO : speed_->getFloat() * drag;
  if (is_click) return arrow_.reset();
  if (!arrow_) arrow_ = std::make_unique<rviz::Arrow>(scene_manager_);
  const float length = drag.length(), head = std::min(0.3f * length, 0.3f),
              width = 0.08f * std::min(1.0f, length);
  arrow_->set(length - head, width, head, 2.5f * width);
  arrow_->setPosition(*position_);
  arrow_->setDirection(drag);
  arrow_->setColor(0.85f, 0.5f, 0.1f, 0.9f);
}

int SpawnTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.panel->contextMenuVisible()) return 0;
  if (event.rightDown()) right_pressed_at_ = QPoint(event.x, event.y);
  if (event.type == QEvent::Wheel && event.wheel_delta != 0) {
    constexpr float kNotch = 120.0f;
    const float factor = std::pow(1.1f, static_cast<float>(event.wheel_delta) / kNotch);
    size_->setFloat(std::min(std::max(factor * size_->getFloat(), kSmallest), kLargest));
    if (!drags_) place(event);
  } else if (event.rightUp() && event.buttons_down == Qt::NoButton && isNearPress(event)) {
    boost::shared_ptr<QMenu> menu(new QMenu);
    for (const GhostShape& shape : kShapes)
      menu->addAction(shape.name, [this, name = shape.name] { shape_->setString(name); });
    event.panel->showContextMenu(menu);
  } else if (event.leftDown() && position_) {
    drags_ = true;
    velocity_ = Ogre::Vector3::ZERO;
  } else if (event.leftUp() && drags_) {
    spawn();
    drags_ = false;
    arrow_.reset();
  } else if (drags_) {
    aim(event);
  } else if (event.middle() || event.right()) {
    if (rviz::ViewController* const view = context_->getViewManager()->getCurrent())
      view->handleMouseEvent(event);
  } else if (event.type == QEvent::MouseMove) {
    place(event);
  }
  return Render;
}

// A right drag moves the view and opens no menu.
bool SpawnTool::isNearPress(const rviz::ViewportMouseEvent& event) const {
  return (QPoint(event.x, event.y) - right_pressed_at_).manhattanLength() < QApplication::startDragDistance();
}

void SpawnTool::spawn() {
  rigid_body_sim::SpawnBody::Request body;
  body.shape = shape_->getStdString();
  body.size.x = body.size.y = body.size.z = size_->getFloat();
  if (body.shape == "cylinder" || body.shape == "cone") body.size.y = 0.0;
  if (body.shape == "sphere") body.size.y = body.size.z = 0.0;
  body.frame_id = context_->getFixedFrame().toStdString();
  body.pose.position.x = position_->x;
  body.pose.position.y = position_->y;
  body.pose.position.z = position_->z;
  body.pose.orientation.w = 1.0;
  body.twist.linear.x = velocity_.x;
  body.twist.linear.y = velocity_.y;
  body.twist.linear.z = velocity_.z;
  body.density = density_->getFloat();
  body.is_static = is_static_->getBool();
  if (body.is_static) body.twist = geometry_msgs::Twist();
  body.material.friction = {friction_->getFloat()};
  body.material.restitution = {restitution_->getFloat()};
  SimulationPanel::spawn(context_->getWindowManager()->getParentWindow(), body);
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::SpawnTool, rviz::Tool)

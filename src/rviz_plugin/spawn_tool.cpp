// SPDX-License-Identifier: BSD-3-Clause
#include "spawn_tool.h"

#include "mouse_ray.h"
#include "simulation_panel.h"

#include "rigid_body_sim/mesh_file.h"

#include <OgreCamera.h>
#include <OgrePlane.h>
#include <OgreRay.h>
#include <OgreViewport.h>
#include <ros/package.h>
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
#include <chrono>
#include <cmath>
#include <exception>
#include <thread>
#include <variant>
#include <vector>

namespace rbs {
namespace {

constexpr float kSmallest = 1e-3f, kLargest = 1e3f;  // m

const char* const kSpawnShapes[] = {"box", "sphere", "capsule", "cylinder", "cone", "mesh"};
constexpr const char* kHelp =
    "<b>Left-Click:</b> Add. <b>Left-Drag:</b> Throw. <b>Wheel:</b> Size. <b>Right-Click:</b> Shape. "
    "<b>Middle:</b> Move the view.";

Vec3 fromOgre(const Ogre::Vector3& v) {
  return {v.x, v.y, v.z};
}

Ogre::Vector3 ogreVector(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Ogre::Quaternion ogreVector(const Quat& q) {
  return {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
          static_cast<float>(q.z())};
}

template <class Message>
void setVector(Message& message, const Vec3& v) {
  message.x = v.x(), message.y = v.y(), message.z = v.z();
}

std::optional<Ogre::Vector3> meet(const Ogre::Ray& ray, const Ogre::Plane& plane) {
  const auto [meets, distance] = ray.intersects(plane);
  return meets ? std::make_optional(ray.getPoint(distance)) : std::nullopt;
}

}  // namespace

SpawnTool::SpawnTool() {
  shortcut_key_ = 'b';
  rviz::Property* const container = getPropertyContainer();
  shape_ = new rviz::EnumProperty("Shape", "box", "Shape of the new bodies.", container);
  for (std::size_t k = 0; k < std::size(kSpawnShapes); ++k)
    shape_->addOption(kSpawnShapes[k], static_cast<int>(k));
  mesh_ = new rviz::StringProperty(
      "Mesh", "",
      "File whose convex hull the bodies have with the shape mesh: an absolute path or package://NAME/FILE "
      "that ends in .obj, .stl, .ply, .gltf, .glb or .dae.",
      container);
  size_ = new rviz::FloatProperty("Size", 0.5f, "The largest full extent, m.", container);
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
  connect(shape_, &rviz::Property::changed, this, [this] { takeShape(); });
  connect(mesh_, &rviz::Property::changed, this, [this] { takeShape(); });
  connect(size_, &rviz::Property::changed, this, [this] { showGhost(); });
}

SpawnTool::~SpawnTool() = default;

void SpawnTool::onInitialize() {
  setName("Add body");
  setIcon(rviz::loadPixmap("package://rigid_body_sim/icons/classes/Spawn.svg"));
  setDescription("Adds bodies where the mouse is");
  findPackagesBy(ros::package::getPath);
}

void SpawnTool::activate() {
  ghost_ = std::make_unique<Ghost>(*scene_manager_);
  takeShape();
}

void SpawnTool::deactivate() {
  ghost_.reset();
  arrow_.reset();
  position_.reset();
  drags_ = false;
}

void SpawnTool::takeShape() {
  if (!ghost_) return;
  const std::string name = shape_->getStdString();
  setStatus(kHelp);
  if (name == "capsule") return take({makeShape(name, {0.5, 0.5, 1.0}, name), Quat::Identity()});
  if (name != "mesh") return take({makeShape(name, Vec3::Ones(), name), Quat::Identity()});
  unit_.reset();
  showGhost();
  const std::string file = mesh_->getStdString();
  if (file.empty()) return setStatus("Give a mesh file in the Tool Properties panel.");
  setStatus(QString::fromStdString("Reading " + file));
  std::packaged_task<Standing()> reading([file] {
    const PlacedHull placed = hullOfMesh(file, "", 1.0, "mesh");
    return Standing{scaled(placed.hull, 1.0 / fullExtents(placed.hull).maxCoeff()), placed.X_PB.q_WB};
  });
  coming_ = reading.get_future();
  std::thread(std::move(reading)).detach();
}

void SpawnTool::take(const Standing& standing) {
  coming_ = {};
  unit_ = standing;
  ghost_->setShape(standing.shape);
  showGhost();
}

void SpawnTool::takeMeshWhenRead() {
  if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    take(coming_.get());
    setStatus(kHelp);
  } catch (const std::exception& refusal) {
    setStatus(QString::fromStdString(refusal.what()).toHtmlEscaped());
  }
}

void SpawnTool::showGhost() {
  if (!ghost_) return;  // another tool is in use
  if (!position_ || !unit_) return ghost_->hide();
  ghost_->show(size_->getFloat(), *position_, ogreVector(unit_->q_WB));
}

// The normal is that of the plane through four points around the mouse. Where the middle is not midway between
// them, they lie across an edge, and say nothing about the surface.
std::optional<SpawnTool::Surface> SpawnTool::surfaceUnder(const rviz::ViewportMouseEvent& event) {
  using Ogre::Vector3;
  const auto pointAt = [&](int right, int down) {
    Vector3 point;
    const bool is_hit =
        context_->getSelectionManager()->get3DPoint(event.viewport, event.x + right, event.y + down, point);
    return is_hit && fromOgre(point).allFinite() ? std::make_optional(point) : std::nullopt;
  };
  const std::optional<Vector3> middle = pointAt(0, 0);
  if (!middle) {
    const std::optional<Vector3> on_floor = meet(mouseRay(event), Ogre::Plane(Vector3::UNIT_Z, 0.0f));
    return on_floor ? std::make_optional(Surface{*on_floor, Vector3::UNIT_Z}) : std::nullopt;
  }
  const auto acrossMiddle = [&](int right, int down) -> std::optional<Vector3> {
    constexpr float kFlat = 0.2f;
    const std::optional<Vector3> begin = pointAt(-right, -down), end = pointAt(right, down);
    if (!begin || !end) return std::nullopt;
    const Vector3 across = *end - *begin;
    const bool is_flat = (*begin + *end - 2.0f * *middle).length() < kFlat * across.length();
    return is_flat ? std::make_optional(across) : std::nullopt;
  };
  constexpr int kReach = 8;  // pixels
  const std::optional<Vector3> right = acrossMiddle(kReach, 0), down = acrossMiddle(0, kReach);
  if (!right || !down) return Surface{*middle, Vector3::UNIT_Z};
  const Vector3 normal = right->crossProduct(*down).normalisedCopy();
  const bool faces_away = normal.dotProduct(mouseRay(event).getDirection()) > 0.0f;
  return Surface{*middle, faces_away ? -normal : normal};
}

// The body reaches the surface along -n, where it is reach(-n) from its centre.
void SpawnTool::place(const rviz::ViewportMouseEvent& event) {
  constexpr double kClear = 1.01;  // just above the surface
  const std::optional<Surface> surface = unit_ ? surfaceUnder(event) : std::nullopt;
  position_.reset();
  if (surface) {
    const Vec3 n_B = unit_->q_WB.conjugate() * fromOgre(surface->normal);
    const double height = kClear * size_->getFloat() * reach(unit_->shape, -n_B);
    position_ = surface->point + ogreVector(height * fromOgre(surface->normal));
  }
  showGhost();
}

// In the plane of the view, through the ghost.
void SpawnTool::aim(const rviz::ViewportMouseEvent& event) {
  const Ogre::Plane plane(event.viewport->getCamera()->getRealDirection(), *position_);
  const std::optional<Ogre::Vector3> end = meet(mouseRay(event), plane);
  if (!end) return;
  const Ogre::Vector3 drag = *end - *position_;
  const bool is_click = drag.length() < 0.1f * size_->getFloat();
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
  takeMeshWhenRead();
  if (event.rightDown()) right_pressed_at_ = QPoint(event.x, event.y);
  if (event.type == QEvent::Wheel && event.wheel_delta != 0) {
    constexpr float kNotch = 120.0f;
    const float factor = std::pow(1.1f, static_cast<float>(event.wheel_delta) / kNotch);
    size_->setFloat(std::min(std::max(factor * size_->getFloat(), kSmallest), kLargest));
    if (!drags_) place(event);
  } else if (event.rightUp() && event.buttons_down == Qt::NoButton && isNearPress(event)) {
    boost::shared_ptr<QMenu> menu(new QMenu);
    for (const char* const shape : kSpawnShapes)
      menu->addAction(shape, [this, shape] { shape_->setString(shape); });
    event.panel->showContextMenu(menu);
  } else if (event.leftDown() && position_ && unit_) {
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
  const double size = size_->getFloat();
  body.shape = shapeName(unit_->shape);
  if (const ConvexHull* const hull = std::get_if<ConvexHull>(&unit_->shape)) {
    for (const Vec3& vertex : hull->polyhedron->vertices)
      setVector(body.points.emplace_back(), size * vertex);
  } else {
    setVector(body.size, size * fullExtents(unit_->shape));
  }
  body.frame_id = context_->getFixedFrame().toStdString();
  setVector(body.pose.position, fromOgre(*position_));
  setVector(body.pose.orientation, unit_->q_WB.vec());
  body.pose.orientation.w = unit_->q_WB.w();
  setVector(body.twist.linear, fromOgre(velocity_));
  body.density = density_->getFloat();
  body.is_static = is_static_->getBool();
  if (body.is_static) body.twist = geometry_msgs::Twist();
  body.material.friction = {friction_->getFloat()};
  body.material.restitution = {restitution_->getFloat()};
  SimulationPanel::spawn(context_->getWindowManager()->getParentWindow(), body);
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::SpawnTool, rviz::Tool)

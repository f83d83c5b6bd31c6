// SPDX-License-Identifier: BSD-3-Clause
#include "body_markers.h"

#include <interactive_markers/tools.h>

#include <algorithm>

#include "body_menu.h"
#include "convert.h"
#include "meshes.h"

namespace rbs {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::Marker;

constexpr double kPatch = 0.05;  // side of a plane's click target over the distance of the view's eye

// Size of what belongs to a body in the view, m.
double scaleOf(const Shape& shape, const View& view) {
  if (std::holds_alternative<Plane>(shape)) return kPatch * (view.eye - view.target).norm();
  return 2.0 * boundingRadius(shape);
}

InteractiveMarker markerAt(const std::string& name, const Pose& pose, double scale) {
  InteractiveMarker marker;
  marker.header.frame_id = worldFrame();
  marker.name = name;
  marker.pose = toMsg(pose);
  marker.scale = static_cast<float>(scale);
  return marker;
}

Marker coloredShape(int type, const Vec3& size, const Color& color) {
  Marker shape;
  shape.type = type;
  shape.pose.orientation.w = 1.0;
  shape.scale = toMsg(size);
  shape.color = toMsg(color);
  return shape;
}

// A control acts along or about its x axis, so it is turned until that is `axis` of the marker.
InteractiveMarkerControl axisControl(const std::string& name, int mode, const Vec3& axis) {
  InteractiveMarkerControl control;
  control.name = name;
  control.interaction_mode = mode;
  control.orientation = toMsg(Quat::FromTwoVectors(Vec3::UnitX(), axis));
  return control;
}

// Slightly larger than the body, so that the mouse meets it before the drawn body. It cannot be quite
// invisible: RViz logs a line for every marker that is. RViz's own sphere has so many triangles that a
// hundred of these would halve its frame rate.
Marker clickShape(const Shape& shape, const View& view) {
  constexpr double kOutside = 1.02;
  constexpr Color kNearlyInvisible{1.0f, 1.0f, 1.0f, 0.01f};
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    Marker ball = coloredShape(Marker::TRIANGLE_LIST, Vec3(1.0, 1.0, 1.0), kNearlyInvisible);
    ball.points = icosahedronMesh(kOutside * sphere->radius);
    return ball;
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    return coloredShape(Marker::CUBE, kOutside * box->size, kNearlyInvisible);
  }
  if (!std::holds_alternative<Plane>(shape)) {
    Marker mesh = coloredShape(Marker::TRIANGLE_LIST, Vec3::Constant(kOutside), kNearlyInvisible);
    mesh.points = coarseMesh(shape);
    return mesh;
  }
  const double side = scaleOf(shape, view);
  return coloredShape(Marker::CUBE, Vec3(side, side, 0.02 * side), {1.0f, 1.0f, 1.0f, 0.3f});
}

}  // namespace

std::string handleName(int face) {
  const char* const names[kFaces] = {"+x", "-x", "+y", "-y", "+z", "-z"};
  return std::string("selection.") + names[face];
}

int handleFace(const std::string& marker_name) {
  for (int face = 0; face < kFaces; ++face) {
    if (marker_name == handleName(face)) return face;
  }
  return -1;
}

bool isOfSelection(const std::string& marker_name) {
  return marker_name == kGizmoName || handleFace(marker_name) >= 0;
}

Vec3 faceNormal(int face) {
  return (face % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(face / 2);
}

InteractiveMarker clickTarget(const BodyDescription& body, const Pose& pose, const View& view,
                              const MenuScope& scope) {
  InteractiveMarkerControl control;
  control.name = "body";
  control.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  control.orientation.w = 1.0;
  control.markers.push_back(clickShape(body.shape, view));

  InteractiveMarker marker = markerAt(body.name, pose, scaleOf(body.shape, view));
  marker.controls.push_back(control);
  marker.menu_entries = menuEntries(body, scope);
  return marker;
}

// Rings and arrows reach around the body. Those of a long body would be around the viewer as well, so they are
// no larger than a part of the view, unless the body's middle extent hides them.
double gizmoScale(const Shape& shape, const View& view) {
  constexpr double kAround = 1.5, kOfView = 0.4;
  const double around = kAround * scaleOf(shape, view);
  if (std::holds_alternative<Plane>(shape)) return around;
  Vec3 extents = fullExtents(shape);
  std::sort(extents.data(), extents.data() + 3);
  return std::min(around, std::max(kOfView * (view.eye - view.target).norm(), kAround * extents[1]));
}

// RViz's own rings are a third as wide as their radius and would take clicks meant for bodies behind them.
InteractiveMarker gizmo(const BodyDescription& body, const Pose& pose, const View& view) {
  constexpr float kRingWidth = 0.08f;  // of the radius
  InteractiveMarker marker = markerAt(kGizmoName, pose, gizmoScale(body.shape, view));
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const Vec3 direction = Vec3::Unit(axis);
    marker.controls.push_back(axisControl("move_" + name, InteractiveMarkerControl::MOVE_AXIS, direction));
    marker.controls.push_back(axisControl("turn_" + name, InteractiveMarkerControl::ROTATE_AXIS, direction));
    interactive_markers::makeDisc(marker, marker.controls.back(), kRingWidth);
  }
  return marker;
}

InteractiveMarker faceHandle(const BodyDescription& body, const Pose& pose, int face) {
  const Vec3 n_B = faceNormal(face);
  const double side = 0.3 * boundingRadius(body.shape);
  const double distance = reach(body.shape, n_B) + side;
  Color color{0.2f, 0.2f, 0.2f, 1.0f};
  color[face / 2] = 0.9f;

  InteractiveMarkerControl control = axisControl("resize", InteractiveMarkerControl::MOVE_AXIS, n_B);
  control.markers.push_back(coloredShape(Marker::CUBE, Vec3::Constant(side), color));

  InteractiveMarker marker =
      markerAt(handleName(face), Pose{pose.p_WB + pose.q_WB * (distance * n_B), pose.q_WB}, side);
  marker.controls.push_back(control);
  return marker;
}

}  // namespace rbs

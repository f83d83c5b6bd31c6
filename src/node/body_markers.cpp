#include "body_markers.h"

#include "body_menu.h"
#include "convert.h"

namespace rbs {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::Marker;

constexpr int kFaces = 6;
constexpr double kPatch = 0.05;  // side of a plane's click target over the view distance

// Size of what belongs to a body in the view, m.
double scaleOf(const Shape& shape, double view_distance) {
  return std::holds_alternative<Plane>(shape) ? kPatch * view_distance : 2.0 * boundingRadius(shape);
}

InteractiveMarker markerAt(const std::string& name, const Pose& pose, double scale) {
  InteractiveMarker marker;
  marker.header.frame_id = kWorldFrame;
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

Vec3 faceNormal(int face) {
  return (face % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(face / 2);
}

InteractiveMarker clickTarget(const BodyDescription& body, const Pose& pose, double view_distance) {
  constexpr double kOutside = 1.02;  // in front of the drawn body, so that the mouse meets it first
  const double scale = scaleOf(body.shape, view_distance);
  const bool is_plane = std::holds_alternative<Plane>(body.shape);
  const Vec3 size = is_plane ? Vec3(scale, scale, 0.02 * scale) : Vec3(kOutside * fullExtents(body.shape));
  const Color color = is_plane ? Color{1.0f, 1.0f, 1.0f, 0.3f} : Color{1.0f, 1.0f, 1.0f, 0.0f};
  const int type = std::holds_alternative<Sphere>(body.shape) ? Marker::SPHERE : Marker::CUBE;

  InteractiveMarkerControl control;
  control.name = "body";
  control.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  control.orientation.w = 1.0;
  control.markers.push_back(coloredShape(type, size, color));

  InteractiveMarker marker = markerAt(body.name, pose, scale);
  marker.controls.push_back(control);
  marker.menu_entries = menuEntries(body);
  return marker;
}

InteractiveMarker gizmo(const BodyDescription& body, const Pose& pose, double view_distance) {
  constexpr double kAround = 1.3;  // rings and arrows outside the body
  InteractiveMarker marker = markerAt(kGizmoName, pose, kAround * scaleOf(body.shape, view_distance));
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const Vec3 direction = Vec3::Unit(axis);
    marker.controls.push_back(axisControl("move_" + name, InteractiveMarkerControl::MOVE_AXIS, direction));
    marker.controls.push_back(axisControl("turn_" + name, InteractiveMarkerControl::ROTATE_AXIS, direction));
  }
  return marker;
}

InteractiveMarker faceHandle(const BodyDescription& body, const Pose& pose, int face) {
  const Vec3 n_B = faceNormal(face);
  const double side = 0.2 * boundingRadius(body.shape);
  const double distance = 0.5 * fullExtents(body.shape)[face / 2] + side;
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

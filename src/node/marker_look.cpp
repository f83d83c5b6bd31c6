// SPDX-License-Identifier: BSD-3-Clause
#include "marker_look.h"

#include <algorithm>
#include <cmath>

#include "convert.h"
#include "meshes.h"

namespace rbs {
namespace {

using visualization_msgs::Marker;

constexpr Tone kTones[] = {Tone::Light, Tone::Dark};

// A power of two near four times the viewing distance: the view is filled, and tiles have round sizes.
double squareSide(const View& view) {
  const double distance = (view.eye - view.target).norm();
  return std::exp2(std::round(std::log2(4.0 * std::max(distance, Limits::min_size))));
}

std_msgs::ColorRGBA toned(const Color& color, Tone tone) {
  constexpr float kDark = 0.55f;
  const float factor = tone == Tone::Light ? 1.0f : kDark;
  return toMsg(Color{factor * color[0], factor * color[1], factor * color[2], color[3]});
}

bool isLocked(const MarkerLook& look) {
  return look.frame != worldFrame();
}

Marker blankMarker(BodyId id, const MarkerLook& look, const Pose& pose, Tone tone) {
  Marker marker;
  marker.header.frame_id = look.frame;
  marker.frame_locked = isLocked(look);
  marker.ns = tone == Tone::Light ? look.ns : look.ns + "_dark";
  marker.id = static_cast<std::int32_t>(id.serial & 0x7fffffff);
  marker.pose = toMsg(isLocked(look) ? Pose{} : pose);
  marker.scale = toMsg(Vec3(1.0, 1.0, 1.0));
  marker.color = toned(look.color, tone);
  return marker;
}

/// RViz's own marker of a shape, or -1 where it has none.
int rvizType(const Shape& shape) {
  if (std::holds_alternative<Sphere>(shape)) return Marker::SPHERE;
  if (std::holds_alternative<Box>(shape)) return Marker::CUBE;
  return std::holds_alternative<Cylinder>(shape) ? Marker::CYLINDER : -1;
}

TriangleMesh meshOf(const MarkerLook& look, Tone tone) {
  if (const auto* sphere = std::get_if<Sphere>(&look.shape)) return sphereMesh(sphere->radius, tone);
  if (const auto* box = std::get_if<Box>(&look.shape)) {
    return tone == Tone::Light ? boxMesh(box->size) : TriangleMesh{};
  }
  if (const auto* hull = std::get_if<ConvexHull>(&look.shape)) {
    return tone == Tone::Light ? polyhedronMesh(*hull->polyhedron) : TriangleMesh{};
  }
  if (std::holds_alternative<Plane>(look.shape)) return squareMesh(look.plane_side, tone);
  return roundMesh(look.shape, tone);
}

}  // namespace

bool operator==(const MarkerLook& a, const MarkerLook& b) {
  return a.ns == b.ns && a.frame == b.frame && a.is_mesh == b.is_mesh && sameShape(a.shape, b.shape) &&
         a.plane_side == b.plane_side && a.color == b.color;
}

MarkerLook lookOf(const BodyDescription& body, const std::string& ns, const std::string& frame, bool is_mesh,
                  const View& view) {
  const bool is_plane = std::holds_alternative<Plane>(body.shape);
  return {ns, frame, is_mesh, body.shape, is_plane ? squareSide(view) : 0.0, body.color};
}

double drawnSize(const MarkerLook& look) {
  return std::max(fullExtents(look.shape).minCoeff(), look.plane_side);
}

std::vector<Marker> markersOf(BodyId id, const MarkerLook& look, const Pose& pose) {
  if (const int type = rvizType(look.shape); !look.is_mesh && type >= 0) {
    Marker marker = blankMarker(id, look, pose, Tone::Light);
    marker.type = type;
    marker.scale = toMsg(fullExtents(look.shape));
    return {marker};
  }
  std::vector<Marker> markers;
  for (const Tone tone : kTones) {
    Marker marker = blankMarker(id, look, pose, tone);
    marker.type = Marker::TRIANGLE_LIST;
    marker.points = meshOf(look, tone);
    if (!marker.points.empty()) markers.push_back(marker);
  }
  return markers;
}

Marker waterMarker(const Fluid& fluid, const std::string& ns, const View& view) {
  const double side = squareSide(view);
  Marker marker;
  marker.header.frame_id = worldFrame();
  marker.ns = ns;
  marker.type = Marker::CUBE;
  marker.pose = toMsg(Pose{Vec3(view.target.x(), view.target.y(), fluid.level), Quat::Identity()});
  marker.scale = toMsg(Vec3(side, side, 1e-4 * side));
  marker.color = toMsg(Color{0.15f, 0.4f, 0.65f, 0.55f});
  return marker;
}

Marker removalOf(const Marker& marker) {
  Marker removal;
  removal.header.frame_id = marker.header.frame_id;
  removal.ns = marker.ns;
  removal.id = marker.id;
  removal.action = Marker::DELETE;
  removal.pose.orientation.w = 1.0;
  return removal;
}

}  // namespace rbs

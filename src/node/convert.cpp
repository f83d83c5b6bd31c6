// SPDX-License-Identifier: BSD-3-Clause
#include "convert.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rbs {
namespace {

double drawable(double coordinate) {
  constexpr double kFar = 1e18;
  return std::clamp(finite(coordinate), -kFar, kFar);
}

}  // namespace

double finite(double value) {
  return std::isfinite(value) ? value : 0.0;
}

bool isFinite(const Pose& pose) {
  return pose.p_WB.allFinite() && pose.q_WB.coeffs().allFinite();
}

geometry_msgs::Vector3 toMsg(const Vec3& v) {
  geometry_msgs::Vector3 msg;
  msg.x = finite(v.x());
  msg.y = finite(v.y());
  msg.z = finite(v.z());
  return msg;
}

geometry_msgs::Point toPoint(const Vec3& p) {
  geometry_msgs::Point msg;
  msg.x = drawable(p.x());
  msg.y = drawable(p.y());
  msg.z = drawable(p.z());
  return msg;
}

geometry_msgs::Quaternion toMsg(const Quat& q) {
  geometry_msgs::Quaternion msg;
  const bool sound = q.coeffs().allFinite();
  msg.x = sound ? q.x() : 0.0;
  msg.y = sound ? q.y() : 0.0;
  msg.z = sound ? q.z() : 0.0;
  msg.w = sound ? q.w() : 1.0;
  return msg;
}

geometry_msgs::Pose toMsg(const Pose& pose) {
  geometry_msgs::Pose msg;
  msg.position = toPoint(pose.p_WB);
  msg.orientation = toMsg(pose.q_WB);
  return msg;
}

geometry_msgs::Transform toTransform(const Pose& pose) {
  const geometry_msgs::Pose msg = toMsg(pose);
  geometry_msgs::Transform transform;
  transform.translation.x = msg.position.x;
  transform.translation.y = msg.position.y;
  transform.translation.z = msg.position.z;
  transform.rotation = msg.orientation;
  return transform;
}

geometry_msgs::Twist toMsg(const Twist& twist) {
  geometry_msgs::Twist msg;
  msg.linear = toMsg(twist.v_WB);
  msg.angular = toMsg(twist.w_WB);
  return msg;
}

std_msgs::ColorRGBA toMsg(const Color& color) {
  std_msgs::ColorRGBA msg;
  msg.r = color[0];
  msg.g = color[1];
  msg.b = color[2];
  msg.a = color[3];
  return msg;
}

rigid_body_sim::Material toMsg(const Material& material, const Shape& shape) {
  rigid_body_sim::Material msg;
  msg.friction = {material.friction};
  msg.restitution = {material.restitution};
  msg.drag_coefficient = {material.drag_coefficient.value_or(defaultDragCoefficient(shape))};
  msg.rolling_resistance = {material.rolling_resistance};
  msg.torsional_resistance = {material.torsional_resistance};
  return msg;
}

rigid_body_sim::BodyDescription toMsg(const BodyDescription& body) {
  rigid_body_sim::BodyDescription msg;
  msg.id = body.id.serial;
  msg.name = body.name;
  msg.shape = shapeName(body.shape);
  msg.size = toMsg(fullExtents(body.shape));
  if (const auto* hull = std::get_if<ConvexHull>(&body.shape)) {
    for (const Vec3& p : hull->polyhedron->vertices) msg.vertices.push_back(toPoint(p));
  }
  msg.kind = kindName(body.kind);
  msg.mass = finite(body.mass);
  msg.density = finite(body.density);
  msg.inertia = toMsg(body.inertia);
  msg.material = toMsg(body.material, body.shape);
  msg.color = toMsg(body.color);
  msg.collision_group = body.group;
  msg.collision_mask = body.mask;
  msg.frozen = body.frozen;
  return msg;
}

Vec3 fromMsg(const geometry_msgs::Vector3& v) {
  return {v.x, v.y, v.z};
}

Vec3 fromMsg(const geometry_msgs::Point& p) {
  return {p.x, p.y, p.z};
}

Quat fromMsg(const geometry_msgs::Quaternion& q) {
  const Quat given(q.w, q.x, q.y, q.z);
  const double norm = given.norm();
  if (norm == 0.0 && given.coeffs().isZero(0.0)) return Quat::Identity();
  return norm > 1e-3 && norm < 1e3 ? Quat(given.normalized()) : given;
}

Pose fromMsg(const geometry_msgs::Pose& pose) {
  return {fromMsg(pose.position), fromMsg(pose.orientation)};
}

Twist fromMsg(const geometry_msgs::Twist& twist) {
  return {fromMsg(twist.linear), fromMsg(twist.angular)};
}

Color fromMsg(const std_msgs::ColorRGBA& color) {
  return {color.r, color.g, color.b, color.a};
}

bool isZero(const geometry_msgs::Vector3& v) {
  return v.x == 0.0 && v.y == 0.0 && v.z == 0.0;
}

bool isZero(const geometry_msgs::Pose& pose) {
  const auto& [p, q] = std::tie(pose.position, pose.orientation);
  return p.x == 0.0 && p.y == 0.0 && p.z == 0.0 && q.x == 0.0 && q.y == 0.0 && q.z == 0.0 && q.w == 0.0;
}

bool isZero(const std_msgs::ColorRGBA& color) {
  return color.r == 0.0f && color.g == 0.0f && color.b == 0.0f && color.a == 0.0f;
}

ros::Time wireStamp(double seconds) {
  constexpr double kLatest = 4e9;  // ros::Time counts seconds in 32 bits
  return ros::Time(1.0 + std::clamp(seconds, 0.0, kLatest));
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Between core types and ROS messages: the one place where the two meet.
//
// Outgoing numbers are always finite, since RViz aborts on any other: what is not becomes 0. (The core
// freezes a body that goes wrong and says so; this is the last line of defence.)
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <rigid_body_sim/BodyDescription.h>
#include <rigid_body_sim/Material.h>
#include <ros/time.h>
#include <std_msgs/ColorRGBA.h>

#include <optional>
#include <string>
#include <vector>

namespace rbs {

double finite(double value);      ///< the value, or 0 where it is NaN or infinite
bool isFinite(const Pose& pose);  ///< whether every number of it is finite
geometry_msgs::Vector3 toMsg(const Vec3& v);
geometry_msgs::Point toPoint(const Vec3& p);  ///< also kept within 1e18 m, whose square a float can hold
geometry_msgs::Quaternion toMsg(const Quat& q);
geometry_msgs::Pose toMsg(const Pose& pose);
geometry_msgs::Transform toTransform(const Pose& pose);
geometry_msgs::Twist toMsg(const Twist& twist);
std_msgs::ColorRGBA toMsg(const Color& color);
rigid_body_sim::Material toMsg(const Material& material, const Shape& shape);
rigid_body_sim::BodyDescription toMsg(const BodyDescription& body);

// Incoming numbers are taken as they are; whether they make sense is for the core to say.
Vec3 fromMsg(const geometry_msgs::Vector3& v);
Vec3 fromMsg(const geometry_msgs::Point& p);
/// Zero is the identity. Normalised, unless it is too far from a unit quaternion to be meant as one: the
/// core refuses that.
Quat fromMsg(const geometry_msgs::Quaternion& q);
Pose fromMsg(const geometry_msgs::Pose& pose);
Twist fromMsg(const geometry_msgs::Twist& twist);
Color fromMsg(const std_msgs::ColorRGBA& color);

/// The one element of a list, or nothing. Throws InvalidInput where there are more.
template <class Value>
std::optional<Value> oneOrNone(const std::vector<Value>& list, const std::string& path) {
  if (list.empty()) return std::nullopt;
  if (list.size() == 1) return list.front();
  throw InvalidInput({{path, std::to_string(list.size()) + " entries", "none, or one"}});
}

/// Whether every number of the message is zero: the way a request leaves a field out.
bool isZero(const geometry_msgs::Vector3& v);
bool isZero(const geometry_msgs::Pose& pose);
bool isZero(const std_msgs::ColorRGBA& color);

/// The stamp of `seconds` of simulation since the node started: 1 s more, since a ROS time of 0 means
/// "not set".
ros::Time wireStamp(double seconds);

}  // namespace rbs

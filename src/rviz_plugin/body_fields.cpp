// SPDX-License-Identifier: BSD-3-Clause
#include "body_fields.h"

#include <tf2/LinearMath/Matrix3x3.h>
#include <tf2/LinearMath/Quaternion.h>

#include <QLocale>
#include <QRegularExpression>

#include <array>
#include <cmath>

namespace rbs {
namespace {

using rigid_body_sim::BodyChange;
using Number = std::optional<double>;

constexpr double kDegree = M_PI / 180.0;

template <class Vector>
auto& part(Vector& v, int k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

bool isPlane(const KnownBody& body) {
  return body.description->shape == "plane";
}

// Round about z: x and y are one number, and so is z of a sphere.
int sizePart(const KnownBody& body, int k) {
  const std::string& shape = body.description->shape;
  if (shape == "sphere") return 0;
  const bool is_round = shape == "capsule" || shape == "cylinder" || shape == "cone";
  return is_round && k == 1 ? 0 : k;
}

Number position(const KnownBody& body, int k) {
  return body.motion ? Number(part(body.motion->pose.position, k)) : std::nullopt;
}

void setPosition(BodyChange& change, const KnownBody& body, int k, double value) {
  change.pose = {body.motion->pose};
  part(change.pose[0].position, k) = value;
}

// Roll, pitch and yaw about the fixed axes x, y and z, in this order (REP 103), degrees.
std::array<double, 3> rollPitchYaw(const geometry_msgs::Quaternion& q) {
  std::array<double, 3> angles{};
  tf2::Matrix3x3(tf2::Quaternion(q.x, q.y, q.z, q.w)).getRPY(angles[0], angles[1], angles[2]);
  for (double& angle : angles) angle /= kDegree;
  return angles;
}

Number rotation(const KnownBody& body, int k) {
  return body.motion ? Number(rollPitchYaw(body.motion->pose.orientation)[k]) : std::nullopt;
}

void setRotation(BodyChange& change, const KnownBody& body, int k, double value) {
  change.pose = {body.motion->pose};
  std::array<double, 3> angles = rollPitchYaw(body.motion->pose.orientation);
  angles[k] = value;
  tf2::Quaternion q;
  q.setRPY(kDegree * angles[0], kDegree * angles[1], kDegree * angles[2]);
  geometry_msgs::Quaternion& turned = change.pose[0].orientation;
  turned.x = q.x();
  turned.y = q.y();
  turned.z = q.z();
  turned.w = q.w();
}

Number velocity(const KnownBody& body, int k) {
  return body.motion ? Number(part(body.motion->twist.linear, k)) : std::nullopt;
}

void setVelocity(BodyChange& change, const KnownBody& body, int k, double value) {
  change.twist = {body.motion->twist};
  part(change.twist[0].linear, k) = value;
}

Number spin(const KnownBody& body, int k) {
  return body.motion ? Number(part(body.motion->twist.angular, k)) : std::nullopt;
}

void setSpin(BodyChange& change, const KnownBody& body, int k, double value) {
  change.twist = {body.motion->twist};
  part(change.twist[0].angular, k) = value;
}

Number size(const KnownBody& body, int k) {
  return isPlane(body) ? std::nullopt : Number(part(body.description->size, k));
}

void setSize(BodyChange& change, const KnownBody& body, int k, double value) {
  change.size.resize(1);
  part(change.size[0], sizePart(body, k)) = value;
}

Number mass(const KnownBody& body, int) {
  return isPlane(body) ? std::nullopt : Number(body.description->mass);
}

void setMass(BodyChange& change, const KnownBody&, int, double value) {
  change.mass = value;
}

Number density(const KnownBody& body, int) {
  return isPlane(body) ? std::nullopt : Number(body.description->density);
}

void setDensity(BodyChange& change, const KnownBody&, int, double value) {
  change.density = value;
}

template <std::vector<double> rigid_body_sim::Material::*list>
Number material(const KnownBody& body, int) {
  const std::vector<double>& value = body.description->material.*list;
  return value.size() == 1 ? Number(value.front()) : std::nullopt;
}

template <std::vector<double> rigid_body_sim::Material::*list>
void setMaterial(BodyChange& change, const KnownBody&, int, double value) {
  change.material.*list = {value};
}

Number group(const KnownBody& body, int) {
  return body.description->collision_group;
}

void setGroup(BodyChange& change, const KnownBody&, int, double value) {
  change.collision_group = {static_cast<std::uint32_t>(value)};
}

Number mask(const KnownBody& body, int) {
  return body.description->collision_mask;
}

void setMask(BodyChange& change, const KnownBody&, int, double value) {
  change.collision_mask = {static_cast<std::uint32_t>(value)};
}

}  // namespace

const std::vector<BodyField>& bodyFields() {
  using M = rigid_body_sim::Material;
  static const std::vector<BodyField> fields = {
      {"Position", "m", "Of the centre of mass, in the world", 3, position, setPosition, false, false},
      {"Rotation", "°", "Roll, pitch and yaw about the axes of the world", 3, rotation, setRotation, false,
       false},
      {"Velocity", "m/s", "Of the centre of mass, along the axes of the world", 3, velocity, setVelocity,
       false, false},
      {"Spin", "rad/s", "Angular velocity, along the axes of the world", 3, spin, setSpin, false, false},
      {"Size", "m", "Full extents along the axes of the body; the mass follows", 3, size, setSize, true,
       false},
      {"Mass", "kg", "The density follows", 1, mass, setMass, true, false},
      {"Density", "kg/m³", "The mass follows", 1, density, setDensity, true, false},
      {"Friction", "", "Coulomb coefficient; a pair uses the geometric mean", 1, material<&M::friction>,
       setMaterial<&M::friction>, false, false},
      {"Restitution", "", "0: no rebound, 1: elastic; a pair uses the larger", 1, material<&M::restitution>,
       setMaterial<&M::restitution>, false, false},
      {"Rolling", "", "Rolling resistance: lever arm of the torque over the radius; a pair adds its two", 1,
       material<&M::rolling_resistance>, setMaterial<&M::rolling_resistance>, false, false},
      {"Torsion", "", "Torsional resistance: lever arm of the torque over the radius; a pair adds its two", 1,
       material<&M::torsional_resistance>, setMaterial<&M::torsional_resistance>, false, false},
      {"Drag", "", "Drag coefficient, in air", 1, material<&M::drag_coefficient>,
       setMaterial<&M::drag_coefficient>, false, false},
      {"Group", "", "Collision groups that it is in, one per bit", 1, group, setGroup, false, true},
      {"Mask", "", "Collision groups that it may collide with, one per bit", 1, mask, setMask, false, true}};
  return fields;
}

QString inText(const BodyField& field, double value) {
  if (field.is_mask) return "0x" + QString::number(static_cast<std::uint32_t>(value), 16);
  // A place or a motion of less than this, of its unit, is noise. What is left of it is short enough for its field.
  constexpr double kNothing = 5e-7;
  const bool is_nothing = field.parts == 3 && !field.above_zero && std::abs(value) < kNothing;
  const QString digits = QString::number(is_nothing ? 0.0 : value, 'g', 6);
  return digits.contains('e') ? QString::number(value, 'g', 3) : digits;
}

std::optional<double> fromText(const BodyField& field, const QString& text) {
  bool is_number = false;
  if (field.is_mask) {
    const std::uint32_t bits = text.trimmed().toUInt(&is_number, 0);
    return is_number ? std::optional<double>(bits) : std::nullopt;
  }
  // 1,5 is 1.5, but 1,000 is 1 to some and 1000 to others.
  static const QRegularExpression unclear(R"(^[+-]?[1-9]\d{0,2},\d{3}$)");
  if (unclear.match(text.trimmed()).hasMatch()) return std::nullopt;
  const double value = QLocale::c().toDouble(text.trimmed().replace(',', '.'), &is_number);
  return is_number && std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

}  // namespace rbs

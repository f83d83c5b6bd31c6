// SPDX-License-Identifier: BSD-3-Clause
#include "state/bodies.h"

#include "base/algebra.h"

#include <algorithm>
#include <cmath>

namespace rbs {

double Traits::dragCoefficient() const {
  return material.drag_coefficient ? *material.drag_coefficient : defaultDragCoefficient(shape);
}

Index Bodies::indexOf(BodyId body) const {
  const auto it = std::lower_bound(id.begin(), id.end(), body);
  return it != id.end() && *it == body ? static_cast<Index>(it - id.begin()) : kNone;
}

Index Bodies::indexOf(const std::string& body) const {
  const BodyId found =
      by_name_.find(body, [this](BodyId one) -> const std::string& { return name[indexOf(one)]; });
  return found ? indexOf(found) : kNone;
}

void Bodies::append(BodyId new_id, const BodyDef& def) {
  id.push_back(new_id);
  pose.push_back(def.pose);
  // A quaternion that is of unit length to rounding stays as it is, so that a saved state is read back bit
  // for bit.
  if (std::abs(def.pose.q_WB.squaredNorm() - 1.0) > 1e-14) pose.back().q_WB.normalize();
  since.push_back(0.0);
  twist.push_back(def.twist);
  Traits t;
  t.shape = def.shape;
  t.kind = def.kind;
  const double body_volume = volume(def.shape);
  t.mass = def.mass ? *def.mass : def.density.value_or(kDefaultDensity) * body_volume;
  t.density = body_volume > 0.0 ? t.mass / body_volume : 0.0;
  t.material = def.material;
  t.group = def.group;
  t.mask = def.mask;
  traits.push_back(t);
  inertia.emplace_back();
  name.push_back(def.name);
  by_name_.insert(def.name, new_id);
  color.push_back(def.color.value_or(defaultColor(new_id, def.kind)));
  advance.emplace_back();
  refresh(size() - 1);
}

void Bodies::erase(Index i) {
  by_name_.erase(name[i], id[i]);
  const auto drop = [i](auto& column) { column.erase(column.begin() + i); };
  drop(id), drop(pose), drop(since), drop(twist), drop(inertia), drop(traits), drop(name), drop(color);
  drop(advance);
}

void Bodies::rename(Index i, const std::string& to) {
  by_name_.erase(name[i], id[i]);
  name[i] = to;
  by_name_.insert(to, id[i]);
}

void Bodies::refresh(Index i) {
  Traits& t = traits[i];
  static_cast<ShapeTraits&>(t) = traitsOf(t.shape);
  t.bounding_radius = boundingRadius(t.shape);
  t.length = characteristicLength(t.shape);
  if (t.frozen || (t.kind == BodyKind::Static && !t.held)) twist[i] = {};

  Inertia& m = inertia[i];
  m.moments = t.mass * momentsPerMass(t.shape);
  m.isotropic = m.moments.maxCoeff() - m.moments.minCoeff() <= 1e-12 * m.moments.maxCoeff();
  m.inv_mass = 0.0;
  m.inv_moments.setZero();
  if (!t.moved_by_forces()) return;
  m.inv_mass = 1.0 / t.mass;
  m.inv_moments = m.moments.cwiseInverse();
}

BodyDescription Bodies::describe(Index i) const {
  const Traits& t = traits[i];
  BodyDescription d;
  d.id = id[i];
  d.name = name[i];
  d.shape = t.shape;
  d.kind = t.kind;
  d.mass = t.mass;
  d.density = t.density;
  d.inertia = inertia[i].moments;
  d.material = t.material;
  d.material.drag_coefficient = t.dragCoefficient();
  d.color = color[i];
  d.group = t.group;
  d.mask = t.mask;
  d.frozen = t.frozen;
  return d;
}

Pose Bodies::poseNow(Index i, double time) const {
  Pose now = pose[i];
  if (inertia[i].lazy_orientation && time != since[i] && !twist[i].w_WB.isZero(0.0))
    now.q_WB = (rotationBy((time - since[i]) * twist[i].w_WB) * now.q_WB).normalized();
  return now;
}

void Bodies::updateOrientation(Index i, double time) {
  pose[i] = poseNow(i, time);
  since[i] = time;
}

BodyDef Bodies::define(Index i, double time) const {
  const Traits& t = traits[i];
  BodyDef def;
  def.name = name[i];
  def.shape = t.shape;
  def.pose = poseNow(i, time);
  def.kind = t.frozen ? BodyKind::Static : t.kind;
  if (def.kind != BodyKind::Static && !t.held)
    def.twist = twist[i];  // what is held is at rest when it is let go
  if (t.mass > 0.0) def.mass = t.mass;
  def.material = t.material;
  def.color = color[i];
  def.group = t.group;
  def.mask = t.mask;
  return def;
}

Color defaultColor(BodyId id, BodyKind kind) {
  if (kind == BodyKind::Static) return {0.62f, 0.64f, 0.66f, 1.0f};
  // Hues a golden angle apart differ well however many there are.
  const double hue = std::fmod(0.08 + 0.618033988749895 * static_cast<double>(id.serial), 1.0) * 6.0;
  const auto channel = [hue](double offset) {
    const double k = std::fmod(offset + hue, 6.0);
    return static_cast<float>(0.92 - 0.62 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  };
  return {channel(5.0), channel(3.0), channel(1.0), 1.0f};
}

}  // namespace rbs

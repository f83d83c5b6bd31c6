// SPDX-License-Identifier: BSD-3-Clause
// Short ways to write a scene in a test.
#pragma once

#include "base/algebra.h"
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

namespace rbs::test {

inline constexpr double kGravity = 9.81;  // m/s²

/// A scene without gravity or bodies.
inline SceneDef emptySpace(double step) {
  SceneDef scene;
  scene.step = step;
  scene.gravity.setZero();
  return scene;
}

inline BodyDef body(const std::string& name, const Shape& shape, const Vec3& p_W) {
  BodyDef def;
  def.name = name;
  def.shape = shape;
  def.pose.p_WB = p_W;
  return def;
}

inline BodyDef ball(const std::string& name, double radius, const Vec3& p_W) {
  return body(name, Sphere{radius}, p_W);
}

inline BodyDef box(const std::string& name, const Vec3& size, const Vec3& p_W) {
  return body(name, Box{size}, p_W);
}

inline BodyDef floorOf(double friction) {
  BodyDef def = body("floor", Plane{}, Vec3::Zero());
  def.kind = BodyKind::Static;
  def.material.friction = friction;
  return def;
}

/// A scene with gravity and a floor at z = 0.
inline SceneDef onFloor(double step, double friction) {
  SceneDef scene;
  scene.step = step;
  scene.bodies.push_back(floorOf(friction));
  return scene;
}

/// A scene, and the same with its bodies made in the opposite order: what holds of a pair may not depend on
/// which of the two is the older.
inline std::array<SceneDef, 2> inBothOrders(const SceneDef& scene) {
  SceneDef reversed = scene;
  std::reverse(reversed.bodies.begin(), reversed.bodies.end());
  return {scene, reversed};
}

/// The scene as the test was asked for: with RBS_YOUNGEST_FIRST in the environment its bodies are made in the
/// opposite order. The tests of physics/ run once each way.
inline SceneDef ordered(const SceneDef& scene) {
  return std::getenv("RBS_YOUNGEST_FIRST") ? inBothOrders(scene)[1] : scene;
}

/// Gravity as it acts on a slope that falls towards +x at an angle: the floor stays level.
inline Vec3 slopeGravity(double angle) {
  return kGravity * Vec3(std::sin(angle), 0.0, -std::cos(angle));
}

inline void advance(World& world, double seconds) {
  const auto steps = static_cast<int>(std::lround(seconds / world.scene().step));
  for (int k = 0; k < steps; ++k) world.step();
}

inline BodyState stateOf(const World& world, const std::string& name) {
  const BodyId id = world.find(name);
  for (const BodyState& state : world.snapshot().states)
    if (state.id == id) return state;
  throw std::out_of_range("no body '" + name + "'");
}

inline double energy(const World& world) {
  const Totals totals = world.totals();
  return totals.kinetic_energy + totals.potential_energy;
}

}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// Scenes of any size to time engines on, and the error of a run of each.
#pragma once

#include "base/random.h"
#include "peers/engine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace rbs::families {

/// A family of scenes: one for each number of bodies.
struct Family {
  SceneDef (*make)(int bodies);
  const char* error;  ///< what its error is, with its unit
  double (*errorOf)(const SceneDef& scene, const std::vector<peers::Motion>& now, double time);
};

inline SceneDef empty(double gravity = 9.81) {
  SceneDef scene;
  scene.step = 1.0 / 60.0;
  scene.gravity = Vec3(0.0, 0.0, -gravity);
  return scene;
}

inline BodyDef boxAt(const Vec3& size, const Vec3& p_W) {
  BodyDef def;
  def.shape = Box{size};
  def.pose.p_WB = p_W;
  def.material.friction = 0.5;
  return def;
}

inline BodyDef ballAt(double radius, const Vec3& p_W) {
  BodyDef def;
  def.shape = Sphere{radius};
  def.pose.p_WB = p_W;
  def.material.friction = 0.5;
  return def;
}

inline void addStatic(SceneDef& scene, BodyDef def) {
  def.kind = BodyKind::Static;
  scene.bodies.push_back(def);
}

inline void addFloor(SceneDef& scene, double half) {
  addStatic(scene, boxAt(Vec3(2.0 * half, 2.0 * half, 2.0), Vec3(0.0, 0.0, -1.0)));
}

/// A pen with a floor and four walls, as wide inside.
inline void addPen(SceneDef& scene, double width, double height) {
  addFloor(scene, width);
  for (const double side : {-1.0, 1.0}) {
    const double at = side * (0.5 * width + 0.5);
    addStatic(scene, boxAt(Vec3(1.0, width + 2.0, height), Vec3(at, 0.0, 0.5 * height)));
    addStatic(scene, boxAt(Vec3(width + 2.0, 1.0, height), Vec3(0.0, at, 0.5 * height)));
  }
}

/// A pyramid of cubes of 1 m, half overlapping, of the largest number of rows that so many bodies fill.
inline SceneDef wall(int bodies) {
  SceneDef scene = empty();
  const int rows = static_cast<int>(0.5 * (std::sqrt(8.0 * bodies + 1.0) - 1.0) + 1e-9);
  addFloor(scene, rows + 10.0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows - row; ++column)
      scene.bodies.push_back(
          boxAt(Vec3::Ones(), Vec3(1.1 * (column + 0.5 * (row - rows + 1)), 0.0, 0.5 + row)));
  return scene;
}

/// Towers of ten cubes, 3 m apart.
inline SceneDef towers(int bodies) {
  SceneDef scene = empty();
  const int side = static_cast<int>(std::ceil(std::sqrt(bodies / 10.0)));
  addFloor(scene, 2.0 * side + 10.0);
  for (int k = 0; k < bodies; ++k) {
    const int tower = k / 10;
    scene.bodies.push_back(boxAt(Vec3::Ones(), Vec3(3.0 * (tower % side - 0.5 * side),
                                                    3.0 * (tower / side - 0.5 * side), 0.5 + k % 10)));
  }
  return scene;
}

/// Balls and cubes of 0.5 m that fall in layers into a pen that they fill a few layers deep, or many. The corners of
/// cubes overlap by up to 144 mm at first.
inline SceneDef fallInto(int bodies, int layers) {
  SceneDef scene = empty();
  const int side = std::max(2, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(bodies) / layers))));
  constexpr double kPitch = 0.65;
  addPen(scene, kPitch * side + 0.2, 0.7 * layers + 4.0);
  SplitMix64 random(7);
  for (int k = 0; k < bodies; ++k) {
    Vec3 p(kPitch * (k % side - 0.5 * (side - 1)), kPitch * (k / side % side - 0.5 * (side - 1)),
           0.5 + 0.7 * (k / side / side));
    p.x() += random.uniform(-0.05, 0.05), p.y() += random.uniform(-0.05, 0.05);
    const Quat q = randomAttitude(random);
    BodyDef def = k % 2 ? boxAt(Vec3::Constant(0.5), p) : ballAt(0.25, p);
    if (k % 2) def.pose.q_WB = q;
    scene.bodies.push_back(def);
  }
  return scene;
}
inline SceneDef rain(int bodies) {
  return fallInto(bodies, 8);
}
inline SceneDef pile(int bodies) {
  return fallInto(bodies, std::max(8, static_cast<int>(bodies / 50)));
}

/// Elastic balls of 0.2 m without gravity, which fill 6.5 % of a box.
inline SceneDef gas(int bodies) {
  SceneDef scene = empty(0.0);
  const int side = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(bodies))));
  constexpr double kPitch = 0.4;
  const double width = kPitch * side;
  const auto smooth = [](BodyDef def) {
    def.material.friction = 0.0, def.material.restitution = 1.0;
    return def;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      addStatic(scene, smooth(boxAt(Vec3::Constant(width + 2.0) - (width + 1.0) * Vec3::Unit(axis),
                                    sign * 0.5 * (width + 1.0) * Vec3::Unit(axis))));
  SplitMix64 random(7);
  for (int k = 0; k < bodies; ++k) {
    BodyDef def =
        smooth(ballAt(0.1, kPitch * Vec3(k % side - 0.5 * (side - 1), k / side % side - 0.5 * (side - 1),
                                         k / side / side - 0.5 * (side - 1))));
    for (int axis = 0; axis < 3; ++axis) def.twist.v_WB[axis] = random.uniform(-3.0, 3.0);
    scene.bodies.push_back(def);
  }
  return scene;
}

/// Balls on a lattice that fall and never meet.
inline SceneDef freeFall(int bodies) {
  SceneDef scene = empty();
  const int side = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(bodies))));
  for (int k = 0; k < bodies; ++k)
    scene.bodies.push_back(ballAt(0.1, Vec3(k % side, k / side % side, k / side / side)));
  return scene;
}

// --- errors

/// How far the body that has moved most is from where it stood.
inline double farthest(const SceneDef& scene, const std::vector<peers::Motion>& now, double) {
  double most = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k)
    most = std::max(most, (now[k].pose.p_WB - scene.bodies[k].pose.p_WB).norm());
  return most;
}

/// How many bodies have left the pen, by its walls or its floor.
inline double escaped(const SceneDef& scene, const std::vector<peers::Motion>& now, double) {
  const double half = 0.5 * std::get<Box>(scene.bodies[0].shape).size.x() * 0.5 + 0.5;
  double n = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const Vec3& p = now[k].pose.p_WB;
    if (scene.bodies[k].kind == BodyKind::Dynamic &&
        !(p.head<2>().cwiseAbs().maxCoeff() < half && p.z() > -0.5))
      ++n;
  }
  return n;
}

/// The change of kinetic energy, of what it was.
inline double energyError(const SceneDef& scene, const std::vector<peers::Motion>& now, double) {
  double before = 0.0, after = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (scene.bodies[k].kind != BodyKind::Dynamic) continue;
    before += scene.bodies[k].twist.v_WB.squaredNorm();
    after += now[k].twist.v_WB.squaredNorm();
  }
  return std::abs(after / before - 1.0);
}

/// How far a body is from where it falls to, at most.
inline double fallError(const SceneDef& scene, const std::vector<peers::Motion>& now, double time) {
  double most = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k)
    most = std::max(
        most, (now[k].pose.p_WB - scene.bodies[k].pose.p_WB - 0.5 * time * time * scene.gravity).norm());
  return most;
}

inline const std::map<std::string, Family>& all() {
  static const std::map<std::string, Family> families{
      {"wall", {wall, "displacement, m", farthest}},
      {"towers", {towers, "displacement, m", farthest}},
      {"rain", {rain, "bodies that escaped", escaped}},
      {"pile", {pile, "bodies that escaped", escaped}},
      {"gas", {gas, "relative change of energy", energyError}},
      {"free_fall", {freeFall, "distance from the parabola, m", fallError}}};
  return families;
}

}  // namespace rbs::families

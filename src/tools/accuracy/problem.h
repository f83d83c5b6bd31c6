// SPDX-License-Identifier: BSD-3-Clause
// A problem whose answer is known, and the list of them. Each is a file of its own in problems/, which adds
// itself.
#pragma once

#include "../../../test/benchmark/peers/engine.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs::accuracy {

using peers::Motion;

struct Problem {
  std::string name;
  std::string sentence;    ///< what it asks, for the report
  std::string against;     ///< "exact" (a known motion) or "invariant" (a quantity that must stay)
  std::string measure;     ///< what the error is, and which scale it is a share of
  peers::Task task;        ///< all but the step
  double duration = 1.0;   ///< s
  bool whole_run = false;  ///< the error is the worst of all steps; else the one at the end
  /// The error of these motions at this time, >= 0, dimensionless.
  std::function<double(double time, const std::vector<Motion>&)> error;
  std::vector<double> steps{1.0 / 5,   1.0 / 10,  1.0 / 15,  1.0 / 30,  1.0 / 60,
                            1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960, 1.0 / 1920};  ///< s
};

inline std::vector<Problem>& problems() {
  static std::vector<Problem> all;
  return all;
}

struct RegisterProblem {
  explicit RegisterProblem(Problem problem) { problems().push_back(std::move(problem)); }
};

// --- words that the problems share

inline constexpr double kGravity = 9.81;  ///< m/s², as in a scene that does not say

inline BodyDef body(Shape shape, double mass, const Vec3& p_W, const Vec3& v_W = Vec3::Zero(),
                    double friction = 0.0, double restitution = 0.0) {
  BodyDef def;
  def.shape = std::move(shape);
  def.mass = mass;
  def.pose.p_WB = p_W;
  def.twist.v_WB = v_W;
  def.material.friction = friction;
  def.material.restitution = restitution;
  return def;
}

inline BodyDef floor(double friction = 0.0, double restitution = 0.0) {
  BodyDef def;
  def.shape = Plane{};
  def.kind = BodyKind::Static;
  def.material.friction = friction;
  def.material.restitution = restitution;
  return def;
}

inline SceneDef scene(std::vector<BodyDef> bodies, const Vec3& gravity = Vec3(0, 0, -kGravity)) {
  SceneDef def;
  def.gravity = gravity;
  def.bodies = std::move(bodies);
  for (std::size_t k = 0; k < def.bodies.size(); ++k) def.bodies[k].name = "body_" + std::to_string(k);
  return def;
}

}  // namespace rbs::accuracy

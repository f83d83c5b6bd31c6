// SPDX-License-Identifier: BSD-3-Clause
// The seam between the accuracy probe and the engines that it measures: one small interface, and an adapter a
// file.
#pragma once

#include "rigid_body_sim/scene.h"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace rbs::peers {

/// Where a body is and how it moves.
struct Motion {
  Pose pose;
  Twist twist;
};

/// A force on the centre of mass of a body, constant for the whole run.
struct Push {
  std::size_t body = 0;         ///< its index in the scene
  Vec3 force_W = Vec3::Zero();  ///< N
};

/// What every engine is given: the same scene, with the step to take.
struct Task {
  SceneDef scene;
  std::vector<Push> pushes;
};

/// Thrown by an adapter for what its engine does not have.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One engine with one task. It never lets a body sleep.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step() = 0;
  virtual std::vector<Motion> read() const = 0;  ///< in the order of the scene
};

/// An engine at one of its settings.
struct EngineSetting {
  std::string engine, setting;
  std::string version;
  std::string sentence;  ///< what the setting is
  std::function<std::unique_ptr<Engine>(const Task&)> make;
  std::string base{};  ///< the setting that it is with one number changed; empty: a setting of its own
};

/// All that are linked in. An adapter adds itself, so that a build leaves one out by not compiling its file.
inline std::vector<EngineSetting>& engineSettings() {
  static std::vector<EngineSetting> settings;
  return settings;
}

struct RegisterEngine {
  explicit RegisterEngine(EngineSetting setting) { engineSettings().push_back(std::move(setting)); }
};

/// Mass of a dynamic body, kg.
inline double massOf(const BodyDef& body) {
  return body.mass.value_or(body.density.value_or(kDefaultDensity) * volume(body.shape));
}

/// What no engine beside ours has.
inline void refuseFluids(const Task& task, const std::string& engine) {
  if (task.scene.air || task.scene.wind || task.scene.fluid)
    throw Unsupported(engine + " has no quadratic drag");
}

}  // namespace rbs::peers

// SPDX-License-Identifier: BSD-3-Clause
// Takes steps of a scene that holds everything but one effect, for a count of its instructions.
// Usage: effects_probe EFFECT full|empty STEPS
#include "base/random.h"
#include "rigid_body_sim/world.h"

#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace {

using namespace rbs;

SceneDef everything() {
  SceneDef scene;
  scene.air = Air{};
  scene.wind = Wind{};
  scene.fluid = Fluid{1000.0, 0.3};
  BodyDef floor;
  floor.shape = Plane{};
  floor.kind = BodyKind::Static;
  scene.bodies.push_back(floor);
  SplitMix64 random(11);
  for (int k = 0; k < 60; ++k) {
    BodyDef def;
    def.shape = k % 2 ? Shape(Sphere{0.15}) : Shape(Box{{0.2, 0.25, 0.3}});
    def.pose.p_WB = Vec3(0.5 * (k % 5), 0.5 * (k / 5 % 4), 0.3 + 0.4 * (k / 20));
    def.twist.v_WB = Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    def.twist.w_WB = Vec3(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
    def.material.restitution = 0.3;
    def.material.rolling_resistance = 0.01;
    scene.bodies.push_back(def);
  }
  return scene;
}

// The same, without what would ask for the effect.
SceneDef without(Effect effect, SceneDef scene) {
  switch (effect) {
    case Effect::Gravity:
      scene.gravity.setZero();
      break;
    case Effect::Buoyancy:
      scene.fluid.reset();
      break;
    case Effect::Drag:
      scene.air.reset();
      scene.wind.reset();
      for (BodyDef& def : scene.bodies) def.material.drag_coefficient = 0.0;
      break;
    case Effect::Collision:
    case Effect::Impacts:
      for (BodyDef& def : scene.bodies) def.mask = 0;
      break;
    case Effect::Friction:
      for (BodyDef& def : scene.bodies) def.material.friction = 0.0;
      break;
    case Effect::Rolling:
      for (BodyDef& def : scene.bodies) def.material.rolling_resistance = 0.0;
      break;
    case Effect::Restitution:
      for (BodyDef& def : scene.bodies) def.material.restitution = 0.0;
      break;
    case Effect::Gyroscopic:
      for (BodyDef& def : scene.bodies)
        if (std::holds_alternative<Box>(def.shape)) def.shape = Box{Vec3::Constant(0.25)};
      break;
    case Effect::Rotation:
      for (BodyDef& def : scene.bodies) {
        if (std::holds_alternative<Box>(def.shape)) def.shape = Sphere{0.12};
        def.material.friction = def.material.rolling_resistance = 0.0;
      }
      break;
    case Effect::Sleeping:
      break;
  }
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: effects_probe EFFECT full|empty STEPS\n";
    return 2;
  }
  try {
    const Effect effect = effectNamed(argv[1]);
    SceneDef scene;
    if (std::string(argv[2]) == "full") scene = without(effect, everything());
    World world(scene);
    for (const StageInfo& stage : world.pipeline())
      if (stage.active && stage.reason.find("forced") != std::string::npos) return 1;
    for (int k = std::atoi(argv[3]); k > 0; --k) world.step();
    std::printf("%016llx\n", static_cast<unsigned long long>(world.stateHash()));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}

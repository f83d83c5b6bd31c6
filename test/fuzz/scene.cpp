// SPDX-License-Identifier: BSD-3-Clause
// The readers of scenes and of saved states.
#include "targets.h"

#include "rigid_body_sim/scenes.h"

namespace rbs::fuzz {
namespace {

constexpr std::size_t kMostBodies = 40;  // so that an input takes milliseconds

void requireFinite(const Vec3& v, const char* what) {
  require(v.allFinite(), std::string(what) + " is not finite");
}

}  // namespace

void requireFinite(const World& world) {
  const Snapshot snapshot = world.snapshot();
  for (const BodyState& state : snapshot.states) {
    requireFinite(state.pose.p_WB, "a position");
    require(state.pose.q_WB.coeffs().allFinite(), "an orientation is not finite");
    requireFinite(state.twist.v_WB, "a velocity");
    requireFinite(state.twist.w_WB, "an angular velocity");
  }
  requireFinite(snapshot.totals.momentum, "the momentum");
  requireFinite(snapshot.air.velocity, "the wind");
}

void scene(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const SceneFile read = parseScene(text, "scene.yaml");
    const std::string written = writeScene(read.scene, read.state);
    const SceneFile again = parseScene(written, "written.yaml");
    require(writeScene(again.scene, again.state) == written, "what is written is read as something else");
    if (read.scene.bodies.size() > kMostBodies) return;
    World world(read.scene, read.state);
    for (int k = 0; k < 3; ++k) world.step();
    requireFinite(world);
  } catch (const InvalidInput&) {
  }
}

void savedState(const std::uint8_t* data, std::size_t size) {
  static const std::string bodies = R"(
bodies:
  - {name: floor, shape: plane, kind: static}
  - {name: crate, position: [0, 0, 0.25]}
  - {name: ball, shape: sphere, size: 0.4, position: [0.1, 0, 0.7]}
  - {name: flyer, position: [3, 0, 2], spin: [0, 0, 3]}
  - {name: belt, kind: kinematic, position: [9, 0, 0], velocity: [1, 0, 0]}
state:
)";
  try {
    const SceneFile read =
        parseScene(bodies + std::string(reinterpret_cast<const char*>(data), size), "state.yaml");
    World world(read.scene, read.state);
    const std::uint64_t hash = world.stateHash();
    const std::string written = writeScene(world.capture(), world.captureState());
    const SceneFile again = parseScene(written, "written.yaml");
    require(World(again.scene, again.state).stateHash() == hash,
            "a state that was written is read as another");
    for (int k = 0; k < 3; ++k) world.step();
    requireFinite(world);
  } catch (const InvalidInput&) {
  }
}

}  // namespace rbs::fuzz

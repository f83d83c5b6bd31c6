// SPDX-License-Identifier: BSD-3-Clause
// Executing commands: each calls the function of World that it is named after.
#include "rigid_body_sim/commands.h"

#include "rigid_body_sim/quote.h"

namespace rbs {
namespace {

using namespace commands;

BodyId bodyNamed(const World& world, const std::string& name) {
  const BodyId body = world.find(name);
  if (!body) throw InvalidInput({{"body", quoted(name), "the name of a body"}});
  return body;
}

void run(World& world, const AddBodies& c) {
  world.addBodies(c.bodies);
}
void run(World& world, const RemoveBody& c) {
  world.removeBody(bodyNamed(world, c.body));
}
void run(World& world, const Clear&) {
  world.clear();
}
void run(World& world, const EditBody& c) {
  world.editBody(bodyNamed(world, c.body), c.edit);
}
void run(World& world, const ApplyImpulse& c) {
  world.applyImpulse(bodyNamed(world, c.body), c.impulse_W, c.point_W);
}
void run(World& world, const ApplyWrench& c) {
  world.applyWrench(bodyNamed(world, c.body), c.force_W, c.torque_W, c.point_W, c.seconds);
}
void run(World& world, const CommandWrench& c) {
  world.commandWrench(bodyNamed(world, c.body), c.force_W, c.torque_W, c.point_W, c.seconds);
}
void run(World& world, const GrabBody& c) {
  world.grab(bodyNamed(world, c.body), c.grab);
}
void run(World& world, const HoldBody& c) {
  world.hold(bodyNamed(world, c.body), c.target);
}
void run(World& world, const ReleaseBody& c) {
  world.release(bodyNamed(world, c.body));
}
void run(World& world, const SetGravity& c) {
  world.setGravity(c.gravity_W);
}
void run(World& world, const SetAir& c) {
  world.setAir(c.air);
}
void run(World& world, const SetWind& c) {
  world.setWind(c.wind);
}
void run(World& world, const SetFluid& c) {
  world.setFluid(c.fluid);
}
void run(World& world, const SetFidelity& c) {
  world.setFidelity(c.setting);
}
void run(World& world, const SetGoal& c) {
  world.setGoal(c.goal);
}
void run(World& world, const SetEffects& c) {
  world.setEffects(c.effects);
}

}  // namespace

void execute(World& world, const Command& command) {
  std::visit([&](const auto& change) { run(world, change); }, command.change);
}

}  // namespace rbs

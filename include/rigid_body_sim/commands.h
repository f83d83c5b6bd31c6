// SPDX-License-Identifier: BSD-3-Clause
// Commands: the changes of a World as data, to be recorded, written, read and executed again.
//
// A command names its body, so it outlives handles, which count anew in every world.
#pragma once

#include "rigid_body_sim/world.h"

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rbs {

/// One struct for each function of World that changes it from outside. Meanings, units and ranges are those of
/// its arguments. `body` is the name of a body at that moment.
namespace commands {

/// World::addBodies().
struct AddBodies {
  std::vector<BodyDef> bodies;  ///< the bodies; a recorded command has the names that the world chose
};
/// World::removeBody().
struct RemoveBody {
  std::string body;  ///< name of the body
};
/// World::clear().
struct Clear {};
/// World::editBody().
struct EditBody {
  std::string body;  ///< name of the body before the edit
  BodyEdit edit;     ///< what changes
};
/// World::applyImpulse().
struct ApplyImpulse {
  std::string body;               ///< name of the body
  Vec3 impulse_W = Vec3::Zero(),  ///< impulse, in W, N s
      point_W = Vec3::Zero();     ///< where it acts, in W, m
};
/// World::applyWrench().
struct ApplyWrench {
  std::string body;             ///< name of the body
  Vec3 force_W = Vec3::Zero(),  ///< force, in W, N
      torque_W = Vec3::Zero(),  ///< torque, in W, N m
      point_W = Vec3::Zero();   ///< where the force acts, in W, m
  double seconds = 0.0;         ///< how long, s of physics time
};
/// World::commandWrench().
struct CommandWrench {
  std::string body;             ///< name of the body
  Vec3 force_W = Vec3::Zero(),  ///< force, in W, N
      torque_W = Vec3::Zero(),  ///< torque, in W, N m
      point_W = Vec3::Zero();   ///< where the force acts, in W, m
  double seconds = 0.0;         ///< how long, s of physics time
};
/// World::grab().
struct GrabBody {
  std::string body;  ///< name of the body
  Grab grab;         ///< the spring
};
/// World::hold().
struct HoldBody {
  std::string body;  ///< name of the body
  Pose target;       ///< pose that it is moved to
};
/// World::release().
struct ReleaseBody {
  std::string body;  ///< name of the body
};
/// World::setGravity().
struct SetGravity {
  Vec3 gravity_W = Vec3::Zero();  ///< in W, m/s²
};
/// World::setAir().
struct SetAir {
  std::optional<Air> air;  ///< empty: none
};
/// World::setWind().
struct SetWind {
  std::optional<Wind> wind;  ///< empty: air at rest
};
/// World::setFluid().
struct SetFluid {
  std::optional<Fluid> fluid;  ///< empty: none
};
/// World::setFidelity(). Adaptive accuracy control (Governor) gives it, too.
struct SetFidelity {
  Setting setting;  ///< solver settings
};
/// World::setGoal().
struct SetGoal {
  std::optional<Goal> goal;  ///< empty: none
};
/// World::setEffects().
struct SetEffects {
  EffectOverrides effects;  ///< effects forced on or off
};

/// Any of them.
using Any = std::variant<AddBodies, RemoveBody, Clear, EditBody, ApplyImpulse, ApplyWrench, CommandWrench,
                         GrabBody, HoldBody, ReleaseBody, SetGravity, SetAir, SetWind, SetFluid, SetFidelity,
                         SetGoal, SetEffects>;

/// The names of the alternatives of Any in text and messages, in their order.
inline constexpr std::array<const char*, std::variant_size_v<Any>> kNames{
    "add_bodies",     "remove_body", "clear",        "edit_body", "apply_impulse", "apply_wrench",
    "command_wrench", "grab",        "hold",         "release",   "set_gravity",   "set_air",
    "set_wind",       "set_fluid",   "set_fidelity", "set_goal",  "set_effects"};

}  // namespace commands

/// One change of a World. The step is none: commands run between steps.
struct Command {
  commands::Any change;  ///< what changes

  /// Its name: "apply_impulse".
  const char* name() const { return commands::kNames[change.index()]; }
};

/// Changes the world as the command says. Throws InvalidInput as the function of World does, and for a name
/// that no body has. Equal worlds stay equal, bit for bit.
void execute(World& world, const Command& command);

/// The text of a command, one line of YAML without an end: "apply_impulse: {body: ..., impulse: [...],
/// point: [...]}". parseCommand() reads it back bit for bit. Keys are those of scene files; a hull has all its
/// vertices.
std::string writeCommand(const Command& command);

/// Reads a command. Throws InvalidInput with every fault of its form: "source:line: path", value, allowed.
/// Ranges are checked when it is executed. `source` is named in messages.
Command parseCommand(const std::string& text, const std::string& source);

}  // namespace rbs

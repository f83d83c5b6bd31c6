// SPDX-License-Identifier: BSD-3-Clause
// The effects a scene may call for, and their names.
#pragma once

#include <array>
#include <map>
#include <string>

namespace rbs {

/// What a scene may call for beyond bodies that keep their motion. Each is simulated where the scene's
/// contents ask for it, unless it is forced on or off.
enum class Effect {
  Gravity,      ///< asked for by a gravity that is not zero
  Buoyancy,     ///< by a fluid
  Drag,         ///< by air or a fluid, and bodies with a drag coefficient above 0; wind included
  Collision,    ///< by two bodies that may meet: broad phase, narrow phase, contacts
  Impacts,      ///< by the same: impacts are located in time, so that nothing passes through anything
  Friction,     ///< by two bodies with friction above 0
  Rolling,      ///< by bodies with rolling or torsional resistance above 0
  Restitution,  ///< by bodies with restitution above 0
  Gyroscopic,   ///< by bodies whose principal moments of inertia differ
  Rotation,     ///< by bodies that something can turn: all but balls without friction
  Sleeping,  ///< by nothing but being forced on: groups at rest for 0.5 s are left out until something comes
             ///< near
};

/// All of them, in the order in which a step meets them.
inline constexpr std::array kEffects{Effect::Gravity,   Effect::Buoyancy,    Effect::Drag,
                                     Effect::Collision, Effect::Impacts,     Effect::Friction,
                                     Effect::Rolling,   Effect::Restitution, Effect::Gyroscopic,
                                     Effect::Rotation,  Effect::Sleeping};

/// "gravity", "buoyancy", …: the name in lower case.
const char* effectName(Effect effect);
/// The effect of this name; throws InvalidInput for any other name.
Effect effectNamed(const std::string& name);

/// Effects forced on (true) or off (false); the others are detected.
using EffectOverrides = std::map<Effect, bool>;

}  // namespace rbs

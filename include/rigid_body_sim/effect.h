// SPDX-License-Identifier: BSD-3-Clause
// The effects that a scene may need, and their names.
#pragma once

#include <array>
#include <map>
#include <string>

namespace rbs {

/// A physical effect that a scene may need, or a way to save time. Each is simulated where the scene's
/// contents need it, unless EffectOverrides force it on or off.
enum class Effect {
  Gravity,    ///< detected where gravity is not zero
  Buoyancy,   ///< detected where there is a fluid
  Drag,       ///< detected where there is air or a fluid, and a drag coefficient above 0; includes wind
  Collision,  ///< detected where two bodies may meet and forces move one: broad phase, narrow phase, contacts
  Impacts,    ///< detected with Collision: impacts are located in time (continuous collision detection)
  Friction,   ///< detected where two bodies that may meet have friction above 0
  Rolling,    ///< detected where a body that may meet another has rolling or torsional resistance above 0
  Restitution,  ///< detected where a body that may meet another has restitution above 0
  Gyroscopic,   ///< detected where the principal moments of inertia of a body differ
  /// Detected where something can change the angular velocity of a body: a contact (of a sphere only with
  /// friction or rolling resistance), the gyroscopic torque, a wrench, a grab, drag on a box, or buoyancy on
  /// anything but a sphere. Other bodies keep their angular velocity.
  Rotation,
  /// Never detected, only forced on. An island at rest for 0.5 s is left out of the step until a moving body
  /// comes near or the world is edited. It saves time and loses what the bodies would still have settled by.
  Sleeping,
};

/// All effects, in the order in which a step meets them.
inline constexpr std::array kEffects{Effect::Gravity,   Effect::Buoyancy,    Effect::Drag,
                                     Effect::Collision, Effect::Impacts,     Effect::Friction,
                                     Effect::Rolling,   Effect::Restitution, Effect::Gyroscopic,
                                     Effect::Rotation,  Effect::Sleeping};

/// Their names, in the same order.
inline constexpr std::array<const char*, kEffects.size()> kEffectNames{
    "gravity", "buoyancy",    "drag",       "collision", "impacts", "friction",
    "rolling", "restitution", "gyroscopic", "rotation",  "sleeping"};

/// The name of the enumerator in lower case: "gravity", "buoyancy", …
const char* effectName(Effect effect);
/// The effect of this name. Throws InvalidInput for any other name.
Effect effectNamed(const std::string& name);

/// Effects forced on (true) or off (false). The others are detected. An effect that the build leaves out
/// stays off.
using EffectOverrides = std::map<Effect, bool>;

}  // namespace rbs

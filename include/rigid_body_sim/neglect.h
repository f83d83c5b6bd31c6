// SPDX-License-Identifier: BSD-3-Clause
// What it does to a scene to force effects on or off.
#pragma once

#include "rigid_body_sim/difference.h"
#include "rigid_body_sim/world.h"

#include <optional>
#include <string>

namespace rbs {

/// How far two runs from the same state have gone apart.
struct Neglect {
  double seconds = 0.0;  ///< of physics time that they ran
  Difference difference;
};

/// Runs a scene as its effects are detected and with `effects` forced, each for up to 0.25 s of physics time
/// and no more than 20,000 steps of bodies, and compares the ends. Empty for a scene too large for one step.
std::optional<Neglect> measureNeglect(SceneDef scene, const SavedState& state,
                                      const EffectOverrides& effects);

/// "in 0.25 s it moves 'box' by 0.31 m and turns 'cone' by 12 degrees".
std::string describe(const Neglect& measured);

}  // namespace rbs

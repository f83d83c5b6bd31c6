// SPDX-License-Identifier: BSD-3-Clause
// The modelling error of effects that are forced on or off, measured on the scene itself.
#pragma once

#include "rigid_body_sim/difference.h"
#include "rigid_body_sim/world.h"

#include <functional>
#include <optional>
#include <string>

namespace rbs {

/// Modelling error of forced effects: the deviation between a run with them and one without.
struct ModellingError {
  double seconds = 0.0;   ///< physics time that both runs took, s
  Difference difference;  ///< deviation of the run with forced effects from the run with detected ones
};

/// Runs the scene from `state` twice, with all effects detected and with `effects` forced, and compares the
/// end states. Each run takes 0.25 s of physics time, rounded up to whole steps. It takes less where the
/// number of bodies times steps would exceed 20,000. Empty for a scene of more than 20,000 bodies, and where
/// `goOn` says no: it is called between the steps. Throws InvalidInput for a faulty scene or state. Cost: the
/// steps of both runs.
std::optional<ModellingError> measureModellingError(SceneDef scene, const SavedState& state,
                                                    const EffectOverrides& effects,
                                                    const std::function<bool()>& goOn);

/// "in 0.25 s 'box' deviates by 0.31 m, and 'cone' deviates by 12 degrees", or "in 0.25 s no body deviates".
std::string describe(const ModellingError& measured);

}  // namespace rbs

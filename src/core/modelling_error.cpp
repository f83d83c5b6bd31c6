// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/modelling_error.h"

#include "algebra.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace rbs {

std::optional<ModellingError> measureModellingError(SceneDef scene, const SavedState& state,
                                                    const EffectOverrides& effects) {
  constexpr double kSeconds = 0.25;
  constexpr std::size_t kMostWork = 20000;  // bodies times steps
  const std::size_t bodies = std::max<std::size_t>(scene.bodies.size(), 1);
  const auto wanted = static_cast<std::size_t>(std::ceil(kSeconds / scene.step - 1e-9));
  const std::size_t steps = std::min(wanted, kMostWork / bodies);
  if (steps == 0) return std::nullopt;

  scene.effects.clear();
  World detected(scene, state);
  scene.effects = effects;
  World forced(std::move(scene), state);
  for (std::size_t k = 0; k < steps; ++k) detected.step(), forced.step();

  return ModellingError{detected.time() - state.time, differenceOf(forced.snapshot(), detected.snapshot())};
}

std::string describe(const ModellingError& measured) {
  const Difference& error = measured.difference;
  std::string words = "in " + text(measured.seconds) + " s ";
  if (error.moved_body.empty() && error.turned_body.empty()) return words + "no body deviates";
  if (!error.moved_body.empty())
    words += "'" + error.moved_body + "' deviates by " + text(error.distance) + " m";
  if (!error.turned_body.empty())
    words += (error.moved_body.empty() ? "'" : ", and '") + error.turned_body + "' deviates by " +
             text(error.angle * 180.0 / kPi) + " degrees";
  return words;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/modelling_error.h"

#include "base/algebra.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>

namespace rbs {

std::optional<ModellingError> measureModellingError(SceneDef scene, const SavedState& state,
                                                    const EffectOverrides& effects,
                                                    const std::function<bool()>& goOn) {
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
  for (std::size_t k = 0; k < steps; ++k) {
    if (!goOn()) return std::nullopt;
    detected.step(), forced.step();
  }

  return ModellingError{detected.time() - state.time, differenceOf(forced.snapshot(), detected.snapshot())};
}

std::string describe(const ModellingError& measured) {
  const Difference& error = measured.difference;
  const std::string distance = text(error.distance) + " m",
                    angle = text(error.angle * 180.0 / kPi) + " degrees";
  const std::string moved = "'" + error.moved_body + "' deviates by " + distance,
                    turned = "'" + error.turned_body + "' deviates by " + angle;
  std::string found = "no body deviates";
  if (!error.moved_body.empty() && error.moved_body == error.turned_body)
    found = moved + " and " + angle;
  else if (!error.moved_body.empty())
    found = error.turned_body.empty() ? moved : moved + ", and " + turned;
  else if (!error.turned_body.empty())
    found = turned;
  return "in " + text(measured.seconds) + " s " + found;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/neglect.h"

#include "algebra.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace rbs {

std::optional<Neglect> measureNeglect(SceneDef scene, const SavedState& state,
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

  return Neglect{detected.time() - state.time, differenceOf(forced.snapshot(), detected.snapshot())};
}

std::string describe(const Neglect& measured) {
  const Difference& neglect = measured.difference;
  std::string words = "in " + text(measured.seconds) + " s it ";
  if (neglect.moved_body.empty() && neglect.turned_body.empty()) return words + "changes nothing";
  if (!neglect.moved_body.empty())
    words += "moves '" + neglect.moved_body + "' by " + text(neglect.distance) + " m";
  if (!neglect.turned_body.empty())
    words += (neglect.moved_body.empty() ? "turns '" : " and turns '") + neglect.turned_body + "' by " +
             text(neglect.angle * 180.0 / kPi) + " degrees";
  return words;
}

}  // namespace rbs

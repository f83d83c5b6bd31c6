#include "rigid_body_sim/neglect.h"

#include "algebra.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace rbs {

std::optional<Neglect> measureNeglect(SceneDef scene, const SavedState& state, const EffectOverrides& effects) {
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

  const Snapshot a = detected.snapshot(), b = forced.snapshot();
  Neglect neglect;
  neglect.seconds = a.time - state.time;
  for (std::size_t k = 0; k < a.states.size(); ++k) {
    const double distance = (a.states[k].pose.p_WB - b.states[k].pose.p_WB).norm();
    const double angle = a.states[k].pose.q_WB.angularDistance(b.states[k].pose.q_WB);
    if (distance > neglect.distance) neglect.distance = distance, neglect.moved_body = (*a.bodies)[k].name;
    if (angle > neglect.angle) neglect.angle = angle, neglect.turned_body = (*a.bodies)[k].name;
  }
  return neglect;
}

std::string describe(const Neglect& neglect) {
  std::string words = "in " + text(neglect.seconds) + " s it ";
  if (neglect.moved_body.empty() && neglect.turned_body.empty()) return words + "changes nothing";
  if (!neglect.moved_body.empty()) words += "moves '" + neglect.moved_body + "' by " + text(neglect.distance) + " m";
  if (!neglect.turned_body.empty())
    words += (neglect.moved_body.empty() ? "turns '" : " and turns '") + neglect.turned_body + "' by " +
             text(neglect.angle * 180.0 / kPi) + " degrees";
  return words;
}

}  // namespace rbs

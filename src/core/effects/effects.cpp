// SPDX-License-Identifier: BSD-3-Clause
#include "effects/effects.h"

#include "base/text.h"
#include "effects_built.h"

#include <string>

namespace rbs {

namespace {

std::string shapesThatMeet(const SceneAnalysis& c) {
  std::string list;
  for (std::size_t k = 0; k < kShapeNames.size(); ++k) {
    const std::string name = kShapeNames[k], plural = name + (name.back() == 'x' ? "es" : "s");
    if (c.shapes[k] > 0)
      list += (list.empty() ? "" : ", ") + count(c.shapes[k], name.c_str(), plural.c_str());
  }
  return list;
}

// Whether there are contacts at all; `what` is what they would ask for.
Need withContacts(const SceneAnalysis& c, Index bodies, const char* what) {
  if (!effects::need(Effect::Collision, c).active)
    return {false, "no contacts: " + effects::need(Effect::Collision, c).reason};
  if (bodies == 0) return {false, std::string("no body that may meet another has ") + what};
  return {true, count(bodies, "body has ", "bodies have ") + what};
}

}  // namespace

namespace detected {

Need collision(const SceneAnalysis& c) {
  if (c.askingFor(Effect::Collision) == 0) return {false, "no two bodies may meet, by their masks"};
  if (c.moved_by_forces == 0 && (c.asleep == 0 || c.kinematic == 0))
    return {false, c.asleep > 0 ? "all bodies sleep" : "no body is moved by forces"};
  return {true, count(c.askingFor(Effect::Collision), "body", "bodies") +
                    " may meet another: " + shapesThatMeet(c)};
}

Need impacts(const SceneAnalysis& c) {
  Need contacts = collision(c);
  if (!effects::need(Effect::Collision, c).active) return {false, "no contacts: " + contacts.reason};
  return {true,
          "continuous collision detection: every pair whose swept bounds overlap is checked, at any speed"};
}

Need friction(const SceneAnalysis& c) {
  if (c.askingFor(Effect::Friction) == 1 && effects::need(Effect::Collision, c).active)
    return {false, "only one body has friction above 0, and a pair needs two"};
  return withContacts(c, c.askingFor(Effect::Friction), "friction above 0");
}

Need rolling(const SceneAnalysis& c) {
  if (effects::isNeglected(Effect::Rotation, c)) return {false, "rotation is switched off"};
  return withContacts(c, c.askingFor(Effect::Rolling), "rolling or torsional resistance above 0");
}

Need restitution(const SceneAnalysis& c) {
  return withContacts(c, c.askingFor(Effect::Restitution), "restitution above 0");
}

Need rotation(const SceneAnalysis& c) {
  if (c.moved_by_forces == 0) return {false, "no body is moved by forces"};
  if (c.askingFor(Effect::Rotation) == 0)
    return {false, "nothing turns a body: orientations are worked out when they are read"};
  return {true, count(c.askingFor(Effect::Rotation), "body", "bodies") + " of " +
                    std::to_string(c.moved_by_forces) + " may be turned, by contacts, user forces or fluids"};
}

Need gyroscopic(const SceneAnalysis& c) {
  if (effects::isNeglected(Effect::Rotation, c)) return {false, "rotation is switched off"};
  if (c.askingFor(Effect::Gyroscopic) == 0) return {false, "no body has principal moments that differ"};
  return {true, count(c.askingFor(Effect::Gyroscopic), "body has", "bodies have") +
                    " principal moments that differ"};
}

// Nothing asks for it: it saves time and costs accuracy.
Need sleeping(const SceneAnalysis&) {
  return {false, "off unless the scene enables it: a body that sleeps does not settle further"};
}

}  // namespace detected

namespace effects {

Need need(Effect effect, const SceneAnalysis& analysis) {
  const auto place = static_cast<std::size_t>(effect);
  const Need detected = kRows[place].detect(analysis);
  if (!built::kEffects[place])
    return {false, "left out of this build" + (detected.active ? ", neglecting: " + detected.reason : "")};
  const auto forced = analysis.scene.effects.find(effect);
  if (forced == analysis.scene.effects.end() || forced->second == detected.active) return detected;
  if (forced->second && kRows[place].isOfContacts() && !need(Effect::Collision, analysis).active)
    return detected;
  return {forced->second,
          (forced->second ? "forced on, although " : "forced off, neglecting: ") + detected.reason};
}

bool isNeglected(Effect effect, const SceneAnalysis& analysis) {
  const auto forced = analysis.scene.effects.find(effect);
  return !built::kEffects[static_cast<std::size_t>(effect)] ||
         (forced != analysis.scene.effects.end() && !forced->second);
}

}  // namespace effects
}  // namespace rbs

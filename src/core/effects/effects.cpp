// SPDX-License-Identifier: BSD-3-Clause
#include "effects/effects.h"

#include "effects_built.h"
#include "text.h"

#include <array>
#include <utility>

namespace rbs::effects {

namespace {

// --- effects that are part of other stages

std::string shapesThatMeet(const Census& c) {
  static constexpr std::array<std::pair<const char*, const char*>, std::variant_size_v<Shape>> kNames{
      {{"sphere", "spheres"},
       {"box", "boxes"},
       {"capsule", "capsules"},
       {"cylinder", "cylinders"},
       {"cone", "cones"},
       {"hull", "hulls"},
       {"plane", "planes"}}};
  std::string list;
  for (std::size_t k = 0; k < kNames.size(); ++k)
    if (c.shapes[k] > 0)
      list += (list.empty() ? "" : ", ") + count(c.shapes[k], kNames[k].first, kNames[k].second);
  return list;
}

Need needCollision(const Census& c) {
  if (c.collidable == 0) return {false, "no two bodies may meet, by their masks"};
  if (c.moved_by_forces == 0 && (c.asleep == 0 || c.led == 0))
    return {false, c.asleep > 0 ? "all bodies sleep" : "no body is moved by forces"};
  return {true, count(c.collidable, "body", "bodies") + " may meet another: " + shapesThatMeet(c)};
}

// Whether there are contacts at all; `what` is what they would ask for.
Need withContacts(const Census& c, Index bodies, const char* what) {
  if (!need(Effect::Collision, c).active) return {false, "no contacts: " + need(Effect::Collision, c).reason};
  if (bodies == 0) return {false, std::string("no body that may meet another has ") + what};
  return {true, count(bodies, "body has ", "bodies have ") + what};
}

Need needImpacts(const Census& c) {
  Need contacts = needCollision(c);
  if (!need(Effect::Collision, c).active) return {false, "no contacts: " + contacts.reason};
  return {true,
          "continuous collision detection: every pair whose swept bounds overlap is checked, at any speed"};
}

Need needFriction(const Census& c) {
  if (c.rough == 1 && need(Effect::Collision, c).active)
    return {false, "only one body has friction above 0, and a pair needs two"};
  return withContacts(c, c.rough, "friction above 0");
}

Need needRolling(const Census& c) {
  return withContacts(c, c.rolling, "rolling or torsional resistance above 0");
}

Need needRestitution(const Census& c) {
  return withContacts(c, c.bouncy, "restitution above 0");
}

Need needRotation(const Census& c) {
  if (c.moved_by_forces == 0) return {false, "no body is moved by forces"};
  if (c.turned == 0) return {false, "nothing turns a body: attitudes are worked out when they are read"};
  return {true, count(c.turned, "body", "bodies") + " of " + std::to_string(c.moved_by_forces) +
                    " may be turned, by contacts, user forces or fluids"};
}

Need needGyroscopic(const Census& c) {
  if (c.asymmetric == 0) return {false, "no body has principal moments that differ"};
  return {true, count(c.asymmetric, "body has", "bodies have") + " principal moments that differ"};
}

// Nothing asks for it: it saves time and costs accuracy.
Need needSleeping(const Census&) {
  return {false, "off unless the scene enables it: a body that sleeps does not settle further"};
}

// --- the table of effects, in the order of kEffects

struct Row {
  Effect effect;
  Need (*detect)(const Census&);
  bool built;
};

constexpr std::array kRows{
    Row{Effect::Gravity, gravity::need, built::gravity},
    Row{Effect::Buoyancy, buoyancy::need, built::buoyancy},
    Row{Effect::Drag, drag::need, built::drag},
    Row{Effect::Collision, needCollision, built::collision},
    Row{Effect::Impacts, needImpacts, built::impacts},
    Row{Effect::Friction, needFriction, built::friction},
    Row{Effect::Rolling, needRolling, built::rolling},
    Row{Effect::Restitution, needRestitution, built::restitution},
    Row{Effect::Gyroscopic, needGyroscopic, built::gyroscopic},
    Row{Effect::Rotation, needRotation, built::rotation},
    Row{Effect::Sleeping, needSleeping, built::sleeping},
};

constexpr bool isInOrder() {
  for (std::size_t k = 0; k < kEffects.size(); ++k)
    if (kRows[k].effect != kEffects[k]) return false;
  return kRows.size() == kEffects.size();
}
static_assert(isInOrder());

}  // namespace

Need need(Effect effect, const Census& census) {
  const Row& row = kRows[static_cast<std::size_t>(effect)];
  const Need detected = row.detect(census);
  if (!row.built)
    return {false, "left out of this build" + (detected.active ? ", neglecting: " + detected.reason : "")};
  const auto forced = census.overrides.find(effect);
  if (forced == census.overrides.end() || forced->second == detected.active) return detected;
  return {forced->second,
          (forced->second ? "forced on, although " : "forced off, neglecting: ") + detected.reason};
}

bool isNeglected(Effect effect, const Census& census) {
  const auto forced = census.overrides.find(effect);
  return !kRows[static_cast<std::size_t>(effect)].built ||
         (forced != census.overrides.end() && !forced->second);
}

}  // namespace rbs::effects

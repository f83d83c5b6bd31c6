// SPDX-License-Identifier: BSD-3-Clause
// The effects: those that are stages of their own, and THE table of all: when a scene needs each, which
// bodies ask for it, and which it turns. CONTRIBUTING.md says how to add one.
#pragma once

#include "state/context.h"

#include <array>
#include <optional>

namespace rbs {

/// Of a centre of mass.
struct FlightEnd {
  Vec3 p_WB, v_WB;  ///< m, m/s
};

namespace gravity {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
}  // namespace gravity

/// The weight of the fluid that bodies displace.
namespace buoyancy {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
}  // namespace buoyancy

/// Quadratic drag towards the velocity of the air, or of a fluid.
namespace drag {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
/// Takes the drag of body i anew, at the velocity that an impact has left it, for the `seconds` of the step after it.
/// Nothing for a body that feels none.
void renew(Context& context, Index i, double seconds);
/// Where body i of this step is and how fast, `seconds` on from (p_WB, v_WB), when nothing touches it. Empty
/// for bodies that the air turns (boxes) and for those that feel no air, and where it stops them at once:
/// there the mean acceleration in step.load says it.
std::optional<FlightEnd> fly(const Context& context, Index i, const Vec3& p_WB, const Vec3& v_WB,
                             double seconds);
}  // namespace drag

/// Forces and torques that were asked for until a given time.
namespace wrenches {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
}  // namespace wrenches

/// User forces: springs that pull bodies to the mouse.
namespace grabs {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
}  // namespace grabs

/// Bodies that follow a drag, as if kinematic: their twist is set so that they reach their target.
namespace holds {
Need need(const SceneAnalysis& analysis);
void run(Context& context);
}  // namespace holds

/// When the effects are needed that are part of other stages. The first is of contacts.
namespace detected {
Need collision(const SceneAnalysis& analysis);
Need impacts(const SceneAnalysis& analysis);
Need friction(const SceneAnalysis& analysis);
Need rolling(const SceneAnalysis& analysis);
Need restitution(const SceneAnalysis& analysis);
Need gyroscopic(const SceneAnalysis& analysis);
Need rotation(const SceneAnalysis& analysis);
Need sleeping(const SceneAnalysis& analysis);
}  // namespace detected

namespace effects {

/// What an effect may ask of a body.
struct Candidate {
  const Traits& traits;
  const Inertia& inertia;
  bool may_meet;  ///< another body, by groups and masks, one of the two moved by forces

  bool isMoved() const { return traits.moved_by_forces(); }
};

struct Row {
  Effect effect;
  /// Whether the scene needs it, and why.
  Need (*detect)(const SceneAnalysis&);
  /// Whether a body asks for it. Those that do are counted (SceneAnalysis::asking), and feel it where it is
  /// on. Null: of no body, since the scene's own numbers decide.
  bool (*asks)(const Candidate&) = nullptr;
  /// Of a force that has a list of the bodies that feel it (BodyLists::feeling), which are then not
  /// ballistic: whether it may turn a body. Null: it is no such force.
  bool (*turns)(const Traits&) = nullptr;

  /// It is a part of contacts, and cannot be forced on without them.
  bool isOfContacts() const {
    return effect == Effect::Impacts || effect == Effect::Friction || effect == Effect::Rolling ||
           effect == Effect::Restitution;
  }
};

/// In the order of kEffects.
inline constexpr std::array kRows{
    Row{Effect::Gravity, gravity::need},
    Row{Effect::Buoyancy, buoyancy::need, [](const Candidate& body) { return body.isMoved(); },
        [](const Traits& t) { return !t.round; }},
    Row{Effect::Drag, drag::need,
        [](const Candidate& body) { return body.isMoved() && body.traits.dragCoefficient() > 0.0; },
        [](const Traits& t) { return std::holds_alternative<Box>(t.shape); }},
    Row{Effect::Collision, detected::collision, [](const Candidate& body) { return body.may_meet; }},
    Row{Effect::Impacts, detected::impacts},
    Row{Effect::Friction, detected::friction,
        [](const Candidate& body) { return body.may_meet && body.traits.material.friction > 0.0; }},
    Row{Effect::Rolling, detected::rolling,
        [](const Candidate& body) {
          const Material& m = body.traits.material;
          return body.may_meet && (m.rolling_resistance > 0.0 || m.torsional_resistance > 0.0);
        }},
    Row{Effect::Restitution, detected::restitution,
        [](const Candidate& body) { return body.may_meet && body.traits.material.restitution > 0.0; }},
    Row{Effect::Gyroscopic, detected::gyroscopic,
        [](const Candidate& body) { return body.isMoved() && !body.inertia.isotropic; }},
    // The analysis counts the bodies that something may turn, once it knows what they feel.
    Row{Effect::Rotation, detected::rotation},
    Row{Effect::Sleeping, detected::sleeping},
};

constexpr bool isInOrder() {
  for (std::size_t k = 0; k < kEffects.size(); ++k)
    if (kRows[k].effect != kEffects[k]) return false;
  return kRows.size() == kEffects.size();
}
static_assert(isInOrder());

/// Whether an effect is simulated, as detected or as forced, and why.
Need need(Effect effect, const SceneAnalysis& analysis);
/// Whether it is forced off, or left out of this build.
bool isNeglected(Effect effect, const SceneAnalysis& analysis);

}  // namespace effects

/// The velocity of the air at a time, gust included, m/s in W.
Vec3 airVelocity(const SceneDef& settings, double time);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The fields of commands, key by key. The writer and the reader go through these lists: a new field is a member
// of its command, and a line here.
#pragma once

#include "rigid_body_sim/commands.h"

namespace rbs::commands {

// Each visits the keys of a command with their members. Where the key is empty, the member has keys of its own.

template <class C, class Visit>
void visitFields(C& command, const AddBodies&, const Visit& visit) {
  visit("bodies", command.bodies);
}
template <class C, class Visit>
void visitFields(C& command, const RemoveBody&, const Visit& visit) {
  visit("body", command.body);
}
template <class C, class Visit>
void visitFields(C&, const Clear&, const Visit&) {}
template <class C, class Visit>
void visitFields(C& command, const EditBody&, const Visit& visit) {
  visit("body", command.body);
  visit("set", command.edit);
}
template <class C, class Visit>
void visitFields(C& command, const ApplyImpulse&, const Visit& visit) {
  visit("body", command.body);
  visit("impulse", command.impulse_W);
  visit("point", command.point_W);
}
template <class C, class Visit>
void visitWrench(C& command, const Visit& visit) {
  visit("body", command.body);
  visit("force", command.force_W);
  visit("torque", command.torque_W);
  visit("point", command.point_W);
  visit("seconds", command.seconds);
}
template <class C, class Visit>
void visitFields(C& command, const ApplyWrench&, const Visit& visit) {
  visitWrench(command, visit);
}
template <class C, class Visit>
void visitFields(C& command, const CommandWrench&, const Visit& visit) {
  visitWrench(command, visit);
}
template <class C, class Visit>
void visitFields(C& command, const GrabBody&, const Visit& visit) {
  visit("body", command.body);
  visit("", command.grab);
}
template <class C, class Visit>
void visitFields(C& command, const HoldBody&, const Visit& visit) {
  visit("body", command.body);
  visit("", command.target);
}
template <class C, class Visit>
void visitFields(C& command, const ReleaseBody&, const Visit& visit) {
  visit("body", command.body);
}
template <class C, class Visit>
void visitFields(C& command, const SetGravity&, const Visit& visit) {
  visit("gravity", command.gravity_W);
}
template <class C, class Visit>
void visitFields(C& command, const SetAir&, const Visit& visit) {
  visit("air", command.air);
}
template <class C, class Visit>
void visitFields(C& command, const SetWind&, const Visit& visit) {
  visit("wind", command.wind);
}
template <class C, class Visit>
void visitFields(C& command, const SetFluid&, const Visit& visit) {
  visit("fluid", command.fluid);
}
template <class C, class Visit>
void visitFields(C& command, const SetFidelity&, const Visit& visit) {
  visit("fidelity", command.setting);
}
template <class C, class Visit>
void visitFields(C& command, const SetGoal&, const Visit& visit) {
  visit("", command.goal);
}
template <class C, class Visit>
void visitFields(C& command, const SetEffects&, const Visit& visit) {
  visit("effects", command.effects);
}

}  // namespace rbs::commands

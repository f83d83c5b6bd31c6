// SPDX-License-Identifier: BSD-3-Clause
#include "step/touching_contacts.h"

namespace rbs::touching_contacts {

void find(Context& context) {
  const auto isMoved = [&](Index i) { return context.scene.bodies.traits[i].moved_by_forces(); };
  for (Contact& contact : context.scene.contacts.active) {
    if (contact.state.isDepenetrating() || !contact.bears()) continue;
    if (!isMoved(contact.i) && !isMoved(contact.j)) continue;
    contact.state.touch();
    for (const Index i : {contact.i, contact.j}) context.step.supported[i] = isMoved(i);
  }
}

}  // namespace rbs::touching_contacts

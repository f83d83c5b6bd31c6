// SPDX-License-Identifier: BSD-3-Clause
#include "effects/contact_forces.h"

namespace rbs {

ContactForces::ContactForces(const Context& context) {
  const Bodies& bodies = context.scene.bodies;
  for (const Contact* contact : context.scene.contacts.withPoints()) {  // of what has just woken as well
    const Index i = bodies.indexOf(contact->key.i), j = bodies.indexOf(contact->key.j);
    for (const SolvedPoint& point : contact->points) {
      if (point.normal == 0.0) continue;
      if (forces_W_.empty()) forces_W_.assign(bodies.size(), Vec3::Zero());
      const Vec3 force_W = point.normal * point.n_W + point.friction_W;
      forces_W_[i] -= force_W;
      forces_W_[j] += force_W;
    }
  }
}

Vec3 ContactForces::on(Index i, const Vec3& load_W) const {
  if (forces_W_.empty()) return Vec3::Zero();
  const double force = forces_W_[i].norm(), most = 2.0 * load_W.norm();
  return force <= most ? forces_W_[i] : Vec3(most / force * forces_W_[i]);
}

}  // namespace rbs

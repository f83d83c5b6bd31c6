// SPDX-License-Identifier: BSD-3-Clause
// Buoyancy: the fluid pushes a body up with the weight of what it displaces, at the centre of that part
// (Archimedes). The surface of the fluid is the plane z = level of W, and stays so.
//
// In time. A floating body is a spring. Its force is taken for the whole step where the body will be in the
// middle of it, at x + h v/2; with x'= x + h v + h² a/2 and v' = v + h a, and a = -W (x + h v/2)/h², the map
// of a step
//   | 1 - W/2    h (1 - W/4) |
//   | -W/h       1 - W/2     |
// has determinant 1: bobbing neither grows nor decays, up to W = (omega h)² = 4. The same for rocking.
#include "base/algebra.h"
#include "base/text.h"
#include "effects/effects.h"
#include "shapes/submerged.h"

#include <limits>

namespace rbs::buoyancy {

Need need(const SceneAnalysis& c) {
  if (!c.scene.fluid) return {false, "the scene has no fluid"};
  if (c.moved_by_forces == 0) return {false, "no body is moved by forces"};
  return {true, "a fluid of " + text(c.scene.fluid->density) + " kg/m^3 up to z = " +
                    text(c.scene.fluid->level) + " m, for " + count(c.moved_by_forces, "body", "bodies") +
                    (c.scene.gravity.norm() > 0.0 ? "" : "; without gravity it has no weight, but it drags")};
}

void run(Context& context) {
  const SceneStore& scene = context.scene;
  const Bodies& bodies = scene.bodies;
  StepStore& step = context.step;
  const double half = 0.5 * step.h();
  // Forced on in a scene without a fluid, it finds every body above the surface.
  const Fluid fluid = scene.settings.fluid.value_or(Fluid{0.0, -std::numeric_limits<double>::infinity()});
  step.submerged.assign(bodies.size(), 0.0);
  for (const Index i : scene.lists.feelingOf(Effect::Buoyancy)) {
    const Twist& twist = bodies.twist[i];
    const Vec3 p_WB = bodies.pose[i].p_WB + half * twist.v_WB;
    const Quat q_WB = rotationBy(half * twist.w_WB) * bodies.pose[i].q_WB;
    const Traits& t = bodies.traits[i];
    if (p_WB.z() - t.bounding_radius >= fluid.level) continue;
    const SubmergedPart part =
        submergedPart(t.shape, (q_WB.conjugate() * Vec3::UnitZ()).normalized(), fluid.level - p_WB.z());
    if (part.volume == 0.0) continue;
    const Vec3 force_W = -fluid.density * part.volume * scene.gravity_W;
    step.load[i].a_W += bodies.inertia[i].inv_mass * force_W;
    step.load[i].torque_W += (q_WB * part.centre_B).cross(force_W);
    step.submerged[i] = part.volume / volume(t.shape);
  }
}

}  // namespace rbs::buoyancy

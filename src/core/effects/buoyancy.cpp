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
//
// What is light or small bobs faster than that: foam of 20 mm has W = 10 in a step of 1/30 s, and would leap out of the
// fluid for ever. From W = 1 on the force is taken further on by a part c = (1 - 1/W)/2 of the step, at the velocity of its
// end, at x + h v/2 + c h (v + h a). With w = W/(1 + c W) = 2 W/(W + 1) < 2 in place of W that is a = -w (x + (1/2 + c) h v)/h²,
// whose map has determinant 1 - c w: bobbing that a step cannot follow dies out, and where the body floats at rest stays
// the same. The force falls as the body rises, so y = v + h a is the one root of y + h f(c h y) = v + h a0, where a0 is the
// acceleration with the force at x + h v/2, and f tells by how much it falls from there. W is the larger one of f at
// h (v + h a0)/2 and at a part of it.
// Torques are softened to w.
// Contacts that push a body decide on a too. In a0 are their forces of the last step; of a body at rest v + h a0 is zero, and the force
// is that at x + h v/2. The more of the buoyancy contacts bear, the less is its torque softened.
#include "base/algebra.h"
#include "base/text.h"
#include "effects/contact_forces.h"
#include "effects/effects.h"
#include "shapes/submerged.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::buoyancy {

Need need(const SceneAnalysis& c) {
  if (!c.scene.fluid) return {false, "the scene has no fluid"};
  if (c.moved_by_forces == 0) return {false, "no body is moved by forces"};
  return {true, "a fluid of " + text(c.scene.fluid->density) + " kg/m^3 up to z = " +
                    text(c.scene.fluid->level) + " m, for " + count(c.moved_by_forces, "body", "bodies") +
                    (c.scene.gravity.norm() > 0.0 ? "" : "; without gravity it has no weight, but it drags")};
}

namespace {

// (omega h)² from which a body bobs too fast for a step.
constexpr double kFastBob = 1.0;
// How far on W is looked for as well, as a share of half a step: all of it may lead out of the water.
constexpr double kNear = 0.0625;
// What is left of the bracket of the root, and the steps that it may take.
constexpr double kRootTolerance = 1e-12;
constexpr int kMostRootSteps = 100;

// The buoyancy of a body where it is in the middle of the step without it, and near there.
struct Floating {
  const Shape& shape;
  const Fluid& fluid;
  Vec3 gravity_W;
  double z;  // of the centre, m
  Quat q_WB;

  SubmergedPart part(double higher, const Quat& q) const {
    return submergedPart(shape, (q.conjugate() * Vec3::UnitZ()).normalized(), fluid.level - z - higher);
  }
  Vec3 force(const SubmergedPart& part) const { return -fluid.density * part.volume * gravity_W; }
  Vec3 torque(const SubmergedPart& part, const Quat& q) const {
    return (q * part.centre_B).cross(force(part));
  }
};

// c of the comment above.
double ahead(double W) {
  return W > kFastBob ? 0.5 * (1.0 - kFastBob / W) : 0.0;
}

// c h y of the comment above, m, where s is v + h a0.
double riseOf(const Floating& body, double s, double mass, double force_z, double h) {
  const auto fallen = [&](double higher) {  // of the speed at the end
    return h * (force_z - body.force(body.part(higher, body.q_WB)).z()) / mass;
  };
  if (s == 0.0) return 0.0;
  const double far = 0.5 * h * s, near = kNear * far;
  const double c = h * ahead(h * std::max(fallen(far) / far, fallen(near) / near));
  if (c == 0.0) return 0.0;
  // The root is between 0 and s: by false position that halves the value at an end that stays (Illinois).
  double lo = 0.0, hi = s, at_lo = -s, at_hi = fallen(c * s), y = s;
  for (int step = 0; step < kMostRootSteps && std::abs(hi - lo) > kRootTolerance * std::abs(s); ++step) {
    y = (lo * at_hi - hi * at_lo) / (at_hi - at_lo);
    const double off = y + fallen(c * y) - s;
    if (off == 0.0) break;
    if ((off > 0.0) == (at_hi > 0.0)) {
      hi = y, at_hi = off, at_lo *= 0.5;
    } else {
      lo = y, at_lo = off, at_hi *= 0.5;
    }
  }
  return c * y;
}

}  // namespace

void run(Context& context) {
  const SceneStore& scene = context.scene;
  const Bodies& bodies = scene.bodies;
  StepStore& step = context.step;
  const double h = step.h(), half = 0.5 * h;
  // Forced on in a scene without a fluid, it finds every body above the surface.
  const Fluid fluid = scene.settings.fluid.value_or(Fluid{0.0, -std::numeric_limits<double>::infinity()});
  step.submerged.assign(bodies.size(), 0.0);
  const ContactForces contacts(context);
  for (const Index i : scene.lists.feelingOf(Effect::Buoyancy)) {
    const Twist& twist = bodies.twist[i];
    const Traits& t = bodies.traits[i];
    const Floating body{t.shape, fluid, scene.gravity_W, bodies.pose[i].p_WB.z() + half * twist.v_WB.z(),
                        rotationBy(half * twist.w_WB) * bodies.pose[i].q_WB};
    // No section of a body is larger than that of the ball about it.
    const double section = kPi * t.bounding_radius * t.bounding_radius;
    const double stiffest = fluid.density * scene.gravity_W.norm() * section * bodies.inertia[i].inv_mass;
    const bool may_be_fast = h * h * stiffest > kFastBob;
    const double speed = twist.v_WB.z() + h * step.load[i].a_W.z();  // at the end, without the fluid
    const double lowest = body.z - t.bounding_radius + (may_be_fast ? half * std::min(speed, 0.0) : 0.0);
    if (lowest >= fluid.level) continue;
    SubmergedPart part = body.part(0.0, body.q_WB);
    Vec3 force_W = body.force(part);
    Vec3 torque_W = body.torque(part, body.q_WB);
    if (may_be_fast) {
      const Vec3 load_W = t.mass * step.load[i].a_W + force_W, carried_W = contacts.on(i, load_W);
      const double lift = force_W.squaredNorm();
      const double borne = lift > 0.0 ? std::clamp(-carried_W.dot(force_W) / lift, 0.0, 1.0) : 0.0;
      const Vec3 turn_W = 0.25 * h * h * (bodies.inertia[i].inverseW(bodies.R_WB(i)) * torque_W);
      if (!turn_W.isZero(0.0)) {
        const Quat q_WB = rotationBy(turn_W) * body.q_WB;
        const double fallen = (torque_W - body.torque(body.part(0.0, q_WB), q_WB)).dot(turn_W);
        const double W = 4.0 * fallen / torque_W.dot(turn_W);
        torque_W /= 1.0 + (1.0 - borne) * ahead(W) * W;
      }
      const double at_end = twist.v_WB.z() + h * (load_W + carried_W).z() / t.mass;
      part = body.part(riseOf(body, at_end, t.mass, force_W.z(), h), body.q_WB);
      force_W = body.force(part);
    }
    if (part.volume == 0.0) continue;
    step.load[i].a_W += bodies.inertia[i].inv_mass * force_W;
    step.load[i].torque_W += torque_W;
    step.submerged[i] = part.volume / volume(t.shape);
  }
}

}  // namespace rbs::buoyancy

// SPDX-License-Identifier: BSD-3-Clause
#include "algebra.h"
#include "effects/effects.h"
#include "text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace rbs::grabs {

Need need(const Census& c) {
  if (c.grabs == 0) return {false, "no hand holds a body"};
  return {true, count(c.grabs, "hand pulls", "hands pull") + " at a body"};
}

namespace {

constexpr double kStandardGravity = 9.80665, kWeightless = 1.0;  // m/s²

// What damps the turning of a body that hangs by a point at r from its centre of mass. It swings about each
// principal axis of its inertia about the point, I_P, against the stiffness m g |r| of its weight; a mode of
// damping ratio z loses speed as 2 z sqrt(I m g |r|), so that the damping matrix is 2 z sqrt(m g |r|)
// sqrt(I_P). z = 0.8 comes to rest soonest: the swing goes 1.5 % beyond. Held nearer to its centre than its
// mean distance k, k² = trace(I) / 2 m, a body hardly swings, but may still spin: it counts as held at k.
// Where nothing weighs, as on Earth.
Mat3 turnDamping(const Vec3& r_W, double mass, const Mat3& inertia_W, const Vec3& gravity_W) {
  constexpr double kRatio = 0.8;
  const double g = gravity_W.norm() > kWeightless ? gravity_W.norm() : kStandardGravity;
  const double reach = std::sqrt(std::max(r_W.squaredNorm(), inertia_W.trace() / (2.0 * mass)));
  const Mat3 inertia_P = inertia_W - mass * crossMatrix(r_W) * crossMatrix(r_W);
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia_P);
  const Vec3 roots = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return 2.0 * kRatio * std::sqrt(mass * g * reach) *
         (axes.eigenvectors() * roots.asDiagonal() * axes.eigenvectors().transpose());
}

}  // namespace

// A user force: a spring and damper between a point of the body and the mouse, and a couple that damps
// turning. Both are taken implicitly over the step h, so that any stiffness is stable.
//
// The couple is T = -D w_end, D = h turnDamping(). It only takes from the turning, and so needs no cap. With
// M = (1 + I^-1 D)^-1 the body answers an impulse P at the point by w_end = M (w + I^-1 (r x P)): as a body
// of inverse inertia M I^-1 that turns at M w.
//
// With C the offset of the point from the mouse, u its velocity at the end of the step were there no spring,
// K the response of the point to an impulse there,
//   K = 1/m - [r] M I^-1 [r],
// and w = 2 pi f, critical damping (ratio 1), implicit Euler of  C'' = -w² C - 2 w C'  gives the impulse
//   P = -K^-1 s (u + b C),   b = w/(2 + h w),   s = h w (2 + h w)/(1 + h w (2 + h w))
// (the soft constraint of Catto, "Soft constraints", GDC 2011). |P| is capped at m a_max h, so the mouse can
// neither lift the immovable nor shoot a body away.
void run(Context& context) {
  StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  const double h = step.h();
  for (const HandGrab& hand : context.scene.grabs) {
    const Index i = bodies.indexOf(hand.body);
    if (i == kNone || !bodies.traits[i].moved_by_forces()) continue;
    const Inertia& inertia = bodies.inertia[i];
    const double mass = bodies.traits[i].mass;
    const Mat3 R_WB = bodies.R_WB(i);
    const Vec3 r_W = R_WB * hand.grab.p_B;
    const Mat3 arm = crossMatrix(r_W);
    const Mat3 inertia_W = R_WB * inertia.moments.asDiagonal() * R_WB.transpose();
    const Mat3 D = h * turnDamping(r_W, mass, inertia_W, context.scene.gravity_W);
    const Mat3 inv_inertia_W = inertia.inverseW(R_WB);
    const Mat3 M = (Mat3::Identity() + inv_inertia_W * D).inverse();
    const Mat3 K = inertia.inv_mass * Mat3::Identity() - arm * M * inv_inertia_W * arm;

    const Vec3 offset = bodies.pose[i].p_WB + r_W - hand.grab.p_W;
    const Vec3 v = bodies.twist[i].v_WB + h * step.load[i].a_W;
    const Vec3 w = M * (bodies.twist[i].w_WB + h * (inv_inertia_W * step.load[i].torque_W));
    const double omega = 2.0 * kPi * hand.grab.frequency;
    const double bias = omega / (2.0 + h * omega);
    const double stiff = h * omega * (2.0 + h * omega);
    Vec3 impulse = -stiff / (1.0 + stiff) * (K.inverse() * (v + w.cross(r_W) + bias * offset));

    const double cap = hand.grab.max_acceleration * mass * h;
    if (impulse.norm() > cap) impulse *= cap / impulse.norm();
    const Vec3 moment = r_W.cross(impulse);
    const Vec3 couple = -D * (w + M * (inv_inertia_W * moment));
    step.load[i].a_W += inertia.inv_mass / h * impulse;
    step.load[i].torque_W += (moment + couple) / h;
  }
}

}  // namespace rbs::grabs

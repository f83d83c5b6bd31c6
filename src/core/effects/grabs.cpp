// SPDX-License-Identifier: BSD-3-Clause
#include "base/algebra.h"
#include "base/text.h"
#include "effects/effects.h"

#include <algorithm>
#include <cmath>

namespace rbs::grabs {

Need need(const SceneAnalysis& c) {
  if (c.grabs == 0) return {false, "no spring pulls at a body"};
  return {true, count(c.grabs, "spring pulls", "springs pull") + " at a body"};
}

namespace {

constexpr double kWeightless = 1.0;  // m/s²
constexpr double kBrake = 40.0;      // 1/s
constexpr double kApproach = 8.0;    // 1/s

// The turning that the user force does not brake: towards hanging, below the point that it holds, no faster
// than a theta, theta being the angle that is left and a = kApproach. So the body falls freely until it is
// that fast and then comes to rest as exp(-a t): sooner than any constant damping lets it, whose best, the
// critical one, takes five times sqrt(l / g) of a pendulum of length l.
//
// r is the point from the centre of mass, e the direction against the load, and u x e / |u x e| with u = r /
// |r| the axis about which the body turns down. The share s of w about this axis is taken in the metric of
// the inertia I_P about the point, s = (axis · I_P w) / (axis · I_P axis): what remains, w - p axis with p
// between 0 and s, then has (w - p axis) · I_P w >= 0, so that a couple -B I_P (w - p axis) never drives the
// body.
Vec3 turningDown(const Vec3& r_W, const Vec3& load_W, const Mat3& inertia_P, const Vec3& w_WB) {
  const Vec3 cross = -r_W.cross(load_W);
  const double sine = cross.norm();
  if (load_W.norm() < kWeightless || sine == 0.0) return Vec3::Zero();
  const Vec3 axis = cross / sine;
  const double theta = std::atan2(sine, -r_W.dot(load_W));
  const double share = axis.dot(inertia_P * w_WB) / axis.dot(inertia_P * axis);
  return std::clamp(share, 0.0, kApproach * theta) * axis;
}

}  // namespace

// A user force: a spring and damper between a point of the body and the mouse, and a couple that brakes
// turning. Both are taken implicitly over the step h, so that any stiffness is stable.
//
// The couple is T = -B I_P (w_end - p), with I_P = I - m [r]² the inertia about the point and p what
// turningDown() permits: about a point that is held still, all that is too much decays as exp(-B t) whatever
// the shape. B = kBrake + 2 Omega, Omega being the rate at which the body would swing, Omega² = m g |r| / I_P
// with the mean of I_P: a crumb that swings faster than kBrake is damped critically, too. The couple only
// takes from the turning, and so needs no cap; at rest it is zero. With D = h B I_P and
// M = (1 + I^-1 D)^-1 the body answers an impulse P at the point by
//   w_end = M (w + I^-1 (D p + r x P)):
// as a body of inverse inertia M I^-1 that turns at M (w + I^-1 D p).
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
  for (const BodyGrab& pull : context.scene.grabs) {
    const Index i = bodies.indexOf(pull.body);
    if (i == kNone || !bodies.traits[i].moved_by_forces()) continue;
    const Inertia& inertia = bodies.inertia[i];
    const double mass = bodies.traits[i].mass;
    const Mat3 R_WB = bodies.R_WB(i);
    const Vec3 r_W = R_WB * pull.grab.p_B;
    const Mat3 arm = crossMatrix(r_W);
    const Mat3 inertia_W = R_WB * inertia.moments.asDiagonal() * R_WB.transpose();
    const Mat3 inertia_P = inertia_W - mass * arm * arm;
    const double swing = std::sqrt(mass * step.load[i].a_W.norm() * r_W.norm() / (inertia_P.trace() / 3.0));
    const Mat3 D = h * (kBrake + 2.0 * swing) * inertia_P;
    const Vec3 permitted = turningDown(r_W, step.load[i].a_W, inertia_P, bodies.twist[i].w_WB);
    const Mat3 inv_inertia_W = inertia.inverseW(R_WB);
    const Mat3 M = (Mat3::Identity() + inv_inertia_W * D).inverse();
    const Mat3 K = inertia.inv_mass * Mat3::Identity() - arm * M * inv_inertia_W * arm;

    const Vec3 offset = bodies.pose[i].p_WB + r_W - pull.grab.p_W;
    const Vec3 v = bodies.twist[i].v_WB + h * step.load[i].a_W;
    const Vec3 w = M * (bodies.twist[i].w_WB + inv_inertia_W * (h * step.load[i].torque_W + D * permitted));
    const double omega = 2.0 * kPi * pull.grab.frequency;
    const double bias = omega / (2.0 + h * omega);
    const double stiff = h * omega * (2.0 + h * omega);
    Vec3 impulse = -stiff / (1.0 + stiff) * (K.inverse() * (v + w.cross(r_W) + bias * offset));

    const double cap = pull.grab.max_acceleration * mass * h;
    if (impulse.norm() > cap) impulse *= cap / impulse.norm();
    const Vec3 moment = r_W.cross(impulse);
    const Vec3 couple = -D * (w + M * (inv_inertia_W * moment) - permitted);
    step.load[i].a_W += inertia.inv_mass / h * impulse;
    step.load[i].torque_W += (moment + couple) / h;
  }
}

}  // namespace rbs::grabs

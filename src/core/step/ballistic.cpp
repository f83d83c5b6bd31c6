// SPDX-License-Identifier: BSD-3-Clause
#include "step/ballistic.h"

#include "state/out_of_bounds.h"

#include "base/text.h"
#include "dynamics/integrate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::ballistic {

namespace {

// A lower bound of the time that a body stays within the limits, s: as long as |p| + |v| t + |g| t²/2 and
// |v| + |g| t do.
double secondsWithinLimits(const Pose& pose, const Twist& twist, double gravity) {
  const double room = Limits::max_position - pose.p_WB.norm();
  const double speed = twist.v_WB.norm();
  const double speed_room = Limits::max_speed - speed;
  if (!(room > 0.0 && speed_room > 0.0)) return 0.0;
  // The positive root of g t²/2 + v t = room, in the form that does not cancel.
  const double slow = speed + std::sqrt(speed * speed + 2.0 * gravity * room);
  const double to_edge = slow > 0.0 ? 2.0 * room / slow : std::numeric_limits<double>::infinity();
  const double to_speed = gravity > 0.0 ? speed_room / gravity : std::numeric_limits<double>::infinity();
  return std::min(to_edge, to_speed);
}

struct OutOfBounds {
  Index body;
  Pose pose;
  Twist twist;
};

// Finds the bodies that would leave the limits in this step, and the time until which no other body can.
std::vector<OutOfBounds> findOutOfBounds(Context& context) {
  SceneStore& scene = context.scene;
  const Bodies& bodies = scene.bodies;
  const double h = context.step.h(), gravity = scene.gravity_W.norm();
  double safe = std::numeric_limits<double>::infinity();
  std::vector<OutOfBounds> leaving;
  for (const Index i : scene.lists.ballistic) {
    const double seconds = 0.99 * secondsWithinLimits(bodies.pose[i], bodies.twist[i], gravity);
    safe = std::min(safe, seconds);
    if (seconds > h) continue;
    Pose pose = bodies.pose[i];
    Twist twist = bodies.twist[i];
    pose.p_WB += h * (twist.v_WB + 0.5 * h * scene.gravity_W);
    twist.v_WB += h * scene.gravity_W;
    if (!withinLimits(pose, twist)) leaving.push_back({i, bodies.pose[i], bodies.twist[i]});
  }
  scene.ballistic_until = context.step.t0 + safe;
  return leaving;
}

}  // namespace

Need need(const SceneAnalysis& c) {
  if (c.ballistic == 0) return {false, "every body can collide or feels more than gravity"};
  return {true, count(c.ballistic, "body feels", "bodies feel") + " gravity alone and cannot collide"};
}

// The whole step of a world in which all bodies are ballistic.
void run(Context& context) {
  SceneStore& scene = context.scene;
  Bodies& bodies = scene.bodies;
  const double h = context.step.h();
  std::vector<OutOfBounds> leaving;
  if (!(context.step.t1 < scene.ballistic_until)) leaving = findOutOfBounds(context);
  const Vec3 dv = h * scene.gravity_W, half_dv = 0.5 * dv;
  for (const Index i : scene.lists.ballistic) {
    bodies.pose[i].p_WB += h * (bodies.twist[i].v_WB + half_dv);
    bodies.twist[i].v_WB += dv;
  }
  for (const Index i : scene.lists.tumbling) {
    rotateFreely(bodies.pose[i].q_WB, bodies.twist[i].w_WB, bodies.inertia[i], h);
    // It spins faster and slower as it tumbles.
    if (bodies.twist[i].w_WB.norm() > Limits::max_spin)
      bringBack(context, i, bodies.pose[i], bodies.twist[i]);
  }
  for (const OutOfBounds& lost : leaving) bringBack(context, lost.body, lost.pose, lost.twist);
  context.step.report.flying += static_cast<std::uint32_t>(scene.lists.ballistic.size());
}

}  // namespace rbs::ballistic

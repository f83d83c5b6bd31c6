// SPDX-License-Identifier: BSD-3-Clause
#include "ballistic.h"

#include "out_of_bounds.h"

#include "integrate.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::ballistic {

namespace {

// For how long a body surely stays within the limits: while |p| + |v| t + |g| t²/2 and |v| + |g| t do; s.
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

struct Stray {
  Index body;
  Pose pose;
  Twist twist;
};

// The bodies that would leave the limits in this step; also finds out until when no other can.
std::vector<Stray> findStrays(Context& context) {
  SceneStore& scene = context.scene;
  const Bodies& bodies = scene.bodies;
  const double h = context.step.h(), gravity = scene.gravity_W.norm();
  double safe = std::numeric_limits<double>::infinity();
  std::vector<Stray> strays;
  for (const Index i : scene.rosters.ballistic) {
    const double seconds = 0.99 * secondsWithinLimits(bodies.pose[i], bodies.twist[i], gravity);
    safe = std::min(safe, seconds);
    if (seconds > h) continue;
    Pose pose = bodies.pose[i];
    Twist twist = bodies.twist[i];
    pose.p_WB += h * (twist.v_WB + 0.5 * h * scene.gravity_W);
    twist.v_WB += h * scene.gravity_W;
    if (!withinLimits(pose, twist)) strays.push_back({i, bodies.pose[i], bodies.twist[i]});
  }
  scene.ballistic_until = context.step.t0 + safe;
  return strays;
}

}  // namespace

Need need(const Census& c) {
  if (c.ballistic == 0) return {false, "no body feels gravity alone and can meet nobody"};
  return {true, count(c.ballistic, "body feels", "bodies feel") + " gravity alone and can meet nobody"};
}

// The whole step of a world of such bodies.
void run(Context& context) {
  SceneStore& scene = context.scene;
  Bodies& bodies = scene.bodies;
  const double h = context.step.h();
  std::vector<Stray> strays;
  if (!(context.step.t1 < scene.ballistic_until)) strays = findStrays(context);
  const Vec3 dv = h * scene.gravity_W, half_dv = 0.5 * dv;
  for (const Index i : scene.rosters.ballistic) {
    bodies.pose[i].p_WB += h * (bodies.twist[i].v_WB + half_dv);
    bodies.twist[i].v_WB += dv;
  }
  for (const Index i : scene.rosters.tumbling)
    rotateFreely(bodies.pose[i].q_WB, bodies.twist[i].w_WB, bodies.inertia[i], h);
  for (const Stray& stray : strays) freeze(context, stray.body, stray.pose, stray.twist);
  context.step.report.flying += static_cast<std::uint32_t>(scene.rosters.ballistic.size());
}

}  // namespace rbs::ballistic

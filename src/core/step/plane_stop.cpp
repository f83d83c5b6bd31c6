// SPDX-License-Identifier: BSD-3-Clause
#include "step/plane_stop.h"

#include "base/algebra.h"
#include "base/text.h"
#include "effects/effects.h"

#include <algorithm>

namespace rbs::plane_stop {

namespace {

// Share of its smallest extent by which a body may go through a plane.
constexpr double kThroughPlane = 0.5;

// How far a body reaches below a plane at these poses, m; negative above it.
double depthBelow(const Traits& body, const Pose& X_WB, const Pose& X_WP) {
  const Vec3 up_W = X_WP.q_WB * Vec3::UnitZ();
  const double height = up_W.dot(X_WB.p_WB - X_WP.p_WB);
  if (height > body.bounding_radius) return -height;
  return reach(body.shape, X_WB.q_WB.conjugate() * -up_W) - height;
}

// What is known of a plane and a body. The two may have been too far apart for a contact when the step began.
Contact& contactOf(Context& context, Index plane, Index i) {
  Contacts& contacts = context.scene.contacts;
  const auto [first, second] = std::minmax(plane, i);
  const Index known = contacts.find(first, second, 0);  // impacts have added some at the end
  return known != kNone ? contacts.active[known] : contacts.dormantOf(context.scene.bodies, first, second);
}

void lift(Context& context, Index plane, Index i) {
  Bodies& bodies = context.scene.bodies;
  const StepStore& step = context.step;
  const Traits& body = bodies.traits[i];
  const Pose& X_WP = bodies.pose[plane];  // at the end of the step, as that of every kinematic body
  const double most = kThroughPlane * body.length, below = depthBelow(body, bodies.pose[i], X_WP);
  if (below <= most) return;
  const double before = depthBelow(body, step.before[i], step.before[plane]);
  const double rise = below - std::max(most, before);
  if (rise <= 0.0) return;
  const Vec3 up_W = X_WP.q_WB * Vec3::UnitZ();
  bodies.pose[i].p_WB += rise * up_W;
  Vec3& v_W = bodies.twist[i].v_WB;
  const Vec3 of_plane_W = velocityAt(bodies.twist[plane], bodies.pose[i].p_WB - X_WP.p_WB);
  const double gained = std::max(0.0, up_W.dot(of_plane_W - v_W));
  v_W += gained * up_W;
  SolvedPoint point;
  point.feature = SolvedPoint::kLifted;
  point.p_W = bodies.pose[i].p_WB - up_W.dot(bodies.pose[i].p_WB - X_WP.p_WB) * up_W;
  point.n_W = plane < i ? up_W : Vec3(-up_W);
  point.separation = rise - below;
  point.normal_impulse = body.mass * gained;
  contactOf(context, plane, i).addEarlier(point);
}

}  // namespace

Need need(const SceneAnalysis& analysis) {
  const Index planes = analysis.shapes[Shape(Plane()).index()];
  if (planes == 0) return {false, "the scene has no plane"};
  if (analysis.moved_by_forces == 0 || !effects::need(Effect::Collision, analysis).active)
    return {false, "nothing can go through a plane"};
  return {true, count(planes, "plane stops", "planes stop") + " what contacts push in deeply"};
}

void run(Context& context) {
  const std::vector<Traits>& traits = context.scene.bodies.traits;
  for (const Index plane : context.scene.lists.planes)
    for (const Index i : context.scene.lists.in_islands)
      if (mayCollide(traits[plane], traits[i])) lift(context, plane, i);
}

}  // namespace rbs::plane_stop

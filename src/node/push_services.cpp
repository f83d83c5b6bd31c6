// SPDX-License-Identifier: BSD-3-Clause
// Services that apply impulses and wrenches to bodies.
#include "services.h"

#include "body_spec.h"
#include "convert.h"
#include "names.h"
#include "words.h"

#include <rigid_body_sim/ApplyImpulse.h>
#include <rigid_body_sim/ApplyWrench.h>

namespace rbs {
namespace {

using rigid_body_sim::ApplyImpulse;
using rigid_body_sim::ApplyWrench;

/// The point of application in W: the one point given in frame F, or the body's centre of mass.
Vec3 pointOfApplication(const World& world, BodyId id, const Pose& X_WF,
                        const std::vector<geometry_msgs::Point>& points) {
  if (const auto p_F = oneOrNone(points, "point"))
    return X_WF.p_WB + X_WF.q_WB * finiteVector(fromMsg(*p_F), "point");
  return world.pose(id).p_WB;
}

std::string applyImpulse(World& world, const ApplyImpulse::Request& request, ApplyImpulse::Response&) {
  const BodyId id = bodyNamed(world, request.name);
  const Pose X_WF = frameNamed(world, request.frame_id);
  const Vec3 impulse_W = X_WF.q_WB * finiteVector(fromMsg(request.impulse), "impulse");
  const Vec3 point_W = pointOfApplication(world, id, X_WF, request.point);
  world.applyImpulse(id, impulse_W, point_W);
  return words("applied an impulse of ", inWords(impulse_W), " N s to '", request.name, "' at ",
               inWords(point_W), " m in ", worldFrame(), request.point.empty() ? ", its centre of mass" : "");
}

std::string applyWrench(World& world, const ApplyWrench::Request& request, ApplyWrench::Response&) {
  const BodyId id = bodyNamed(world, request.name);
  const Pose X_WF = frameNamed(world, request.frame_id);
  const Vec3 force_W = X_WF.q_WB * finiteVector(fromMsg(request.force), "force");
  const Vec3 torque_W = X_WF.q_WB * finiteVector(fromMsg(request.torque), "torque");
  const Vec3 point_W = pointOfApplication(world, id, X_WF, request.point);
  world.applyWrench(id, force_W, torque_W, point_W, request.seconds);
  return words("applying a force of ", inWords(force_W), " N and a torque of ", inWords(torque_W),
               " N m to '", request.name, "' for ", request.seconds, " s at ", inWords(point_W), " m in ",
               worldFrame(), request.point.empty() ? ", its centre of mass" : "");
}

}  // namespace

void Services::offerPushes() {
  offerEdit<ApplyImpulse>("apply_impulse", applyImpulse);
  offerEdit<ApplyWrench>("apply_wrench", applyWrench);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// External forces on single bodies: impulses, wrenches, user forces.
#include "world/world_parts.h"

#include "base/checks.h"
#include "base/text.h"
#include "world/saved_state.h"

namespace rbs {

TimedWrench World::Impl::wrenchOf(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                                  double seconds) const {
  const Index i = require(id);
  const Bodies& bodies = scene.bodies;
  std::vector<Problem> problems;
  checkVector(force_W, Limits::max_impulse, "force", "N", problems);
  checkVector(torque_W, Limits::max_impulse, "torque", "N m", problems);
  checkVector(point_W, Limits::max_position, "point", "m", problems);
  checkPositive(seconds, 1e9, "seconds", "s", problems);
  if (!bodies.traits[i].movable())
    problems.push_back({"body", bodies.name[i], "a dynamic body that is neither held nor frozen"});
  throwIfAny(problems);
  const Pose pose = bodies.poseNow(i, scene.time);
  return {id, force_W, torque_W, pose.q_WB.conjugate() * (point_W - pose.p_WB), scene.time + seconds};
}

void World::applyImpulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W) {
  const Index i = impl_->require(id);
  Bodies& bodies = impl_->scene.bodies;
  std::vector<Problem> problems;
  checkVector(impulse_W, Limits::max_impulse, "impulse", "N s", problems);
  checkVector(point_W, Limits::max_position, "point", "m", problems);
  if (!bodies.traits[i].movable())
    problems.push_back({"body", bodies.name[i], "a dynamic body that is neither held nor frozen"});
  throwIfAny(problems);
  Twist twist = bodies.twist[i];
  twist.v_WB += impulse_W / bodies.traits[i].mass;
  const Pose pose = bodies.poseNow(i, impl_->scene.time);
  const Vec3 torque_B = pose.q_WB.conjugate() * (point_W - pose.p_WB).cross(impulse_W);
  twist.w_WB += pose.q_WB * Vec3(bodies.inertia[i].moments.cwiseInverse().cwiseProduct(torque_B));
  if (twist.v_WB.norm() > Limits::max_speed || twist.w_WB.norm() > Limits::max_spin)
    throw InvalidInput({{"impulse", textOf(impulse_W),
                         "one that leaves the body below " + text(Limits::max_speed) + " m/s and " +
                             text(Limits::max_spin) + " rad/s"}});
  bodies.updateOrientation(i, impl_->scene.time);
  bodies.twist[i] = twist;
  impl_->edited(false, std::vector<Index>{});
  impl_->record([&] { return commands::ApplyImpulse{bodies.name[i], impulse_W, point_W}; });
}

void World::applyWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                        double seconds) {
  impl_->scene.wrenches.push_back(impl_->wrenchOf(id, force_W, torque_W, point_W, seconds));
  const Index i = impl_->require(id);
  impl_->edited(false, std::vector<Index>{i});
  impl_->record([&] {
    return commands::ApplyWrench{impl_->scene.bodies.name[i], force_W, torque_W, point_W, seconds};
  });
}

void World::commandWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                          double seconds) {
  TimedWrench command = impl_->wrenchOf(id, force_W, torque_W, point_W, seconds);
  command.commanded = true;
  const Index i = impl_->require(id);
  std::vector<TimedWrench>& wrenches = impl_->scene.wrenches;
  const auto last = std::find_if(wrenches.begin(), wrenches.end(), [&](const TimedWrench& wrench) {
    return wrench.body == id && wrench.commanded;
  });
  if (last != wrenches.end()) {
    *last = command;
    ++impl_->edits;
  } else {
    wrenches.push_back(command);
    impl_->edited(false, std::vector<Index>{i});
  }
  impl_->record([&] {
    return commands::CommandWrench{impl_->scene.bodies.name[i], force_W, torque_W, point_W, seconds};
  });
}

void World::grab(BodyId id, const Grab& grab) {
  const Index i = impl_->require(id);
  std::vector<Problem> problems;
  checkGrab(grab, "grab", problems);
  if (impl_->scene.bodies.traits[i].kind != BodyKind::Dynamic)
    problems.push_back({"body", impl_->scene.bodies.name[i], "a dynamic body"});
  throwIfAny(problems);
  std::vector<BodyGrab>& grabs = impl_->scene.grabs;
  const auto last =
      std::find_if(grabs.begin(), grabs.end(), [&](const BodyGrab& other) { return other.body == id; });
  if (last != grabs.end()) {
    last->grab = grab;
    ++impl_->edits;
  } else {
    impl_->release(i);
    grabs.push_back({id, grab});
    impl_->edited(false, std::vector<Index>{i});
  }
  impl_->record([&] { return commands::GrabBody{impl_->scene.bodies.name[i], grab}; });
}

void World::hold(BodyId id, const Pose& target) {
  const Index i = impl_->require(id);
  std::vector<Problem> problems;
  if (!(target.p_WB.norm() <= Limits::max_position))
    problems.push_back({"hold.position", textOf(target.p_WB),
                        "at most " + text(Limits::max_position) + " m from the origin"});
  if (!isOrientation(target.q_WB))
    problems.push_back({"hold.orientation", "of norm " + text(target.q_WB.norm()),
                        "a quaternion of a norm of 0.001 to 1000"});
  throwIfAny(problems);
  const Pose unit{target.p_WB, target.q_WB.normalized()};
  std::vector<BodyHold>& holds = impl_->scene.holds;
  const auto last =
      std::find_if(holds.begin(), holds.end(), [&](const BodyHold& other) { return other.body == id; });
  if (last != holds.end()) {
    last->target = unit;
    ++impl_->edits;
  } else {
    impl_->release(i);
    holds.push_back({id, unit});
    impl_->scene.bodies.traits[i].held = true;
    impl_->scene.bodies.refresh(i);
    impl_->edited(false, std::vector<Index>{i});
  }
  impl_->record([&] { return commands::HoldBody{impl_->scene.bodies.name[i], target}; });
}

void World::Impl::release(Index i) {
  Bodies& bodies = scene.bodies;
  letGo(bodies.id[i]);
  if (bodies.traits[i].held) {
    bodies.traits[i].held = false;
    bodies.twist[i] = {};
    bodies.refresh(i);
  }
  edited(false, std::vector<Index>{i});
}

void World::release(BodyId id) {
  const Index i = impl_->require(id);
  impl_->release(i);
  impl_->record([&] { return commands::ReleaseBody{impl_->scene.bodies.name[i]}; });
}

void World::releaseAll() {
  while (!impl_->scene.grabs.empty()) release(impl_->scene.grabs.front().body);
  while (!impl_->scene.holds.empty()) release(impl_->scene.holds.front().body);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "drag.h"

#include "rigid_body_sim/queries.h"

#include <algorithm>

namespace rbs {
namespace {

Vec3 pointAt(const Pose& X_WB, const Vec3& p_B) {
  return X_WB.p_WB + X_WB.q_WB * p_B;
}

// The shape with this full extent along an axis. A round shape keeps its proportions or grows in all
// directions across its axis, and a capsule is at least as long as it is wide.
Shape withExtent(const Shape& shape, int axis, double extent) {
  if (std::holds_alternative<Sphere>(shape)) return Sphere{0.5 * extent};
  Vec3 size = fullExtents(shape);
  size[axis] = extent;
  if (traitsOf(shape).revolved && axis != 2) size.x() = size.y() = extent;
  if (std::holds_alternative<Capsule>(shape)) size.z() = std::max(size.z(), size.x());
  return resized(shape, size, "body");
}

// A handle moved by d along the normal n of its face makes the extent e = e0 + d, e0 being that at the
// press. The body moves along n by as much as its opposite side would move, so that this side stays.
BodyEdit resizeBy(const Resize& grip, const Vec3& handle_W, const Shape& shape, const Pose& pose) {
  constexpr double kLeast =
      0.05;  // fraction of the extent at the press: a handle cannot turn a body inside out
  int axis;
  grip.n_B.cwiseAbs().maxCoeff(&axis);
  const double d = (handle_W - grip.handle_W).dot(grip.n_W);
  const double extent = std::max(grip.extent + d, kLeast * grip.extent);
  BodyEdit edit;
  edit.shape = withExtent(shape, axis, extent);
  const double growth = reach(*edit.shape, -grip.n_B) - reach(shape, -grip.n_B);
  edit.pose = Pose{pose.p_WB + pose.q_WB * (growth * grip.n_B), pose.q_WB};
  return edit;
}

// The pose next to this one at which a body overlaps none that forces do not move: what is pulled into the floor or a wall stays
// on it. It leaves the deepest of them first. In a corner too narrow for it, it stays where the last push has put it.
Pose outsideOfFixed(const Snapshot& now, int which, Pose pose) {
  constexpr int kMostPushes = 16;
  const BodyDescription& body = (*now.bodies)[which];
  std::optional<Snapshot> moved;  // made only where there is something to leave
  for (int k = 0; k < kMostPushes; ++k) {
    std::optional<Neighbour> deepest;
    for (const Neighbour& near : overlaps(now, body.shape, pose)) {
      const BodyDescription& other = (*now.bodies)[now.find(near.body)];
      const bool is_met = (body.group & other.mask) != 0 && (other.group & body.mask) != 0;
      if (near.body == now.states[which].id || other.kind == BodyKind::Dynamic || !is_met) continue;
      if (near.distance < 0.0 && (!deepest || near.distance < deepest->distance)) deepest = near;
    }
    if (!deepest) return pose;
    if (!moved) moved = now;
    moved->states[which].pose = pose;
    const ClosestPoints between = closestPoints(*moved, deepest->body, now.states[which].id);
    pose.p_WB -= between.distance * between.n_W;
  }
  return pose;
}

}  // namespace

Drag::Drag(BodyId body, std::string marker, const Grip& grip, const Pose& handle)
    : body_(body), marker_(std::move(marker)), grip_(grip), handle_(handle), pressed_(handle) {}

void Drag::hear(const std::optional<Pose>& handle) {
  heard_ = Clock::now();
  if (!handle) return;
  if (!first_) first_ = isJump(*handle) ? *handle : pressed_;
  handle_.p_WB = pressed_.p_WB + (handle->p_WB - first_->p_WB);
  handle_.q_WB = handle->q_WB * first_->q_WB.conjugate() * pressed_.q_WB;
  dragged_ = dragged_ || isBeyondClick();
  moved_ = true;
}

bool Drag::isJump(const Pose& handle) const {
  constexpr double kTurn = 0.02;  // rad: a pixel at a radius of 50
  const Carry* const carry = std::get_if<Carry>(&grip_);
  const Resize* const resize = std::get_if<Resize>(&grip_);
  const double jump = carry ? carry->jump : resize ? resize->jump : 0.0;
  return (handle.p_WB - pressed_.p_WB).norm() < jump && handle.q_WB.angularDistance(pressed_.q_WB) < kTurn;
}

// A gizmo or a handle of a face that stands still gives back the same pose, up to the single precision of RViz.
bool Drag::isBeyondClick() const {
  if (const Pull* grip = std::get_if<Pull>(&grip_))
    return (pointAt(handle_, grip->p_B) - pointAt(pressed_, grip->p_B)).norm() > grip->click_slop;
  constexpr double kSingle = 1e-6;  // of the coordinates; rad
  return (handle_.p_WB - pressed_.p_WB).norm() > kSingle * pressed_.p_WB.norm() ||
         handle_.q_WB.angularDistance(pressed_.q_WB) > kSingle;
}

bool Drag::begins() const {
  return dragged_ && !begun_;
}

bool Drag::silent() const {
  return Clock::now() - heard_ > std::chrono::seconds(5);
}

bool Drag::due(const Snapshot& now) const {
  return moved_ || now.paused != applied_to_paused_;
}

void Drag::apply(World& world, const Snapshot& now) {
  const int i = now.find(body_);
  if (i < 0) return;
  moved_ = false;
  applied_to_paused_ = now.paused;
  const BodyDescription& body = (*now.bodies)[i];
  const bool by_force =
      !now.paused && body.kind == BodyKind::Dynamic && !std::holds_alternative<Resize>(grip_);
  if (!by_force) release(world);
  if (!by_force && !dragged_) return;
  if (const Resize* grip = std::get_if<Resize>(&grip_)) {
    world.editBody(body_, resizeBy(*grip, handle_.p_WB, body.shape, world.pose(body_)));
  } else if (by_force) {
    applyUserForce(world);
  } else {
    setPose(world, now, i);
  }
}

// The gripped point p_B of the marker is where the mouse is: p_W = p_WM + R_WM p_B.
void Drag::applyUserForce(World& world) {
  if (const Pull* grip = std::get_if<Pull>(&grip_)) {
    Grab spring;
    spring.p_B = grip->p_B;
    spring.p_W = pointAt(handle_, grip->p_B);
    world.grab(body_, spring);
  } else {
    world.hold(body_, handle_);
  }
  acting_ = true;
}

std::optional<std::pair<Vec3, Vec3>> Drag::spring(const Snapshot& now) const {
  const Pull* const grip = std::get_if<Pull>(&grip_);
  const int i = now.find(body_);
  if (!grip || !acting_ || i < 0) return std::nullopt;
  return std::make_pair(pointAt(now.states[i].pose, grip->p_B), pointAt(handle_, grip->p_B));
}

// A pulled body keeps its orientation R_WB, so its gripped point is at p_W when p_WB = p_W - R_WB p_B.
void Drag::setPose(World& world, const Snapshot& now, int which) const {
  BodyEdit edit;
  if (const Pull* grip = std::get_if<Pull>(&grip_)) {
    const Vec3 p_W = pointAt(handle_, grip->p_B);
    const Quat q_WB = world.pose(body_).q_WB;
    edit.pose = Pose{p_W - q_WB * grip->p_B, q_WB};
    if ((*now.bodies)[which].kind == BodyKind::Dynamic) edit.pose = outsideOfFixed(now, which, *edit.pose);
  } else {
    edit.pose = handle_;
  }
  world.editBody(body_, edit);
}

void Drag::release(World& world) {
  if (!acting_) return;
  acting_ = false;
  world.release(body_);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "world/saved_state.h"

#include "base/checks.h"
#include "base/text.h"
#include "narrowphase/manifold.h"
#include "step/sleep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

namespace rbs {

SavedState captureState(const SceneStore& scene) {
  SavedState state;
  state.time = scene.time;
  state.steps = scene.steps;
  for (const Contact* contact : scene.contacts.withPoints()) {
    if (contact->points.empty()) continue;
    SavedState::Contact saved{scene.bodies.indexOf(contact->key.i),
                              scene.bodies.indexOf(contact->key.j),
                              {},
                              contact->exact,
                              contact->points.front().n_W,
                              contact->depth(),
                              contact->touchingSteps(scene.steps)};
    for (const SolvedPoint& point : contact->points)
      saved.points.push_back({point.feature, point.normal, point.friction_W});
    state.contacts.push_back(std::move(saved));
  }
  for (Index i = 0; i < scene.rest.size(); ++i) {
    if (scene.rest[i].steps == 0) continue;
    SavedState::Rest rest{i, scene.rest[i].steps, std::nullopt};
    if (scene.bodies.traits[i].asleep) rest.asleep_with = scene.rest[i].group;
    state.rest.push_back(rest);
  }
  for (Index i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies.inertia[i].lazy_orientation && !scene.bodies.twist[i].w_WB.isZero(0.0))
      state.orientations.push_back({i, scene.bodies.since[i], scene.bodies.pose[i].q_WB});
  for (const TimedWrench& w : scene.wrenches) {
    const Index i = scene.bodies.indexOf(w.body);
    state.wrenches.push_back({i, w.force_W, w.torque_W, w.point_B, w.until, w.commanded});
  }
  return state;
}

SavedState captureExactState(const SceneStore& scene) {
  SavedState state = captureState(scene);
  const Bodies& bodies = scene.bodies;
  for (const BodyGrab& grab : scene.grabs) state.grabs.push_back({bodies.indexOf(grab.body), grab.grab});
  for (const BodyHold& hold : scene.holds) {
    const Index i = bodies.indexOf(hold.body);
    state.holds.push_back({i, hold.target, bodies.twist[i]});
  }
  for (Index i = 0; i < bodies.size(); ++i)
    if (bodies.traits[i].frozen) state.frozen.push_back({i, bodies.traits[i].kind == BodyKind::Kinematic});
  return state;
}

void checkGrab(const Grab& grab, const std::string& path, std::vector<Problem>& problems) {
  checkVector(grab.p_B, Limits::max_position, path + ".p_B", "m", problems);
  checkVector(grab.p_W, Limits::max_position, path + ".p_W", "m", problems);
  checkPositive(grab.frequency, 1e4, path + ".frequency", "Hz", problems);
  checkPositive(grab.max_acceleration, 1e9, path + ".max_acceleration", "m/s^2", problems);
}

namespace {

// Numbers of user forces are those that a world has taken, so only their form is checked.
void checkUserForces(const SavedState& saved, Index bodies, std::vector<Problem>& problems) {
  for (const SavedState::Grabbed& grabbed : saved.grabs) {
    if (grabbed.body >= bodies)
      problems.push_back({"state.grabs", std::to_string(grabbed.body), "the index of a body"});
    checkGrab(grabbed.grab, "state.grabs", problems);
  }
  for (const SavedState::Held& held : saved.holds) {
    if (held.body >= bodies)
      problems.push_back({"state.holds", std::to_string(held.body), "the index of a body"});
    checkVector(held.target.p_WB, Limits::max_position, "state.holds.position", "m", problems);
    if (!(std::abs(held.target.q_WB.norm() - 1.0) < 1e-9))
      problems.push_back(
          {"state.holds.orientation", text(held.target.q_WB.norm()), "a quaternion of norm 1"});
    if (!held.twist.v_WB.allFinite() || !held.twist.w_WB.allFinite())
      problems.push_back({"state.holds.velocity", "", "finite velocities"});
  }
  for (const SavedState::Frozen& frozen : saved.frozen)
    if (frozen.body >= bodies)
      problems.push_back({"state.frozen", std::to_string(frozen.body), "the index of a body"});
}

}  // namespace

std::vector<Problem> validate(const SavedState& saved, const SceneDef& settings, const Bodies& known) {
  const Index bodies = known.size();
  std::vector<Problem> problems;
  // From then on a part of a step is off by more than this share of its length, since rounding is.
  constexpr double kOff = 1e-3;
  const double part = settings.step / settings.fidelity.divisions;
  const double latest = kOff * part / std::numeric_limits<double>::epsilon();
  if (!(saved.time >= 0.0 && saved.time <= latest))
    problems.push_back({"state.time", text(saved.time), "0 to " + text(latest) + " s with this step"});
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const SavedState::Contact& contact : saved.contacts) {
    if (!pairs.insert({contact.a, contact.b}).second)
      problems.push_back(
          {"state.contacts", std::to_string(contact.a) + ", " + std::to_string(contact.b), "each pair once"});
    if (contact.a >= contact.b || contact.b >= bodies || contact.points.size() > Manifold::kPoints)
      problems.push_back({"state.contacts", std::to_string(contact.a) + ", " + std::to_string(contact.b),
                          "two indices of bodies, the smaller first, and at most " +
                              std::to_string(Manifold::kPoints) + " points"});
    if (!(std::abs(contact.n_W.squaredNorm() - 1.0) < 1e-9))
      problems.push_back({"state.contacts", text(contact.n_W.norm()), "a normal of length 1"});
    if (contact.touching_steps > saved.steps)
      problems.push_back(
          {"state.contacts", std::to_string(contact.touching_steps),
           "no more steps of touching than the " + std::to_string(saved.steps) + " of the scene"});
    if (!(std::isfinite(contact.depth) && contact.depth >= 0.0))
      problems.push_back({"state.contacts", text(contact.depth), "a depth that is finite and not negative"});
    for (const SavedState::Contact::Point& point : contact.points)
      if (!std::isfinite(point.normal) || point.normal < 0.0 || !point.tangent_W.allFinite())
        problems.push_back(
            {"state.contacts", text(point.normal), "finite forces, the normal one not negative"});
  }
  for (const SavedState::Orientation& orientation : saved.orientations)
    if (orientation.body >= bodies || !(orientation.since >= 0.0 && orientation.since <= saved.time) ||
        !(std::abs(orientation.q_WB.norm() - 1.0) < 1e-9))
      problems.push_back({"state.orientations", std::to_string(orientation.body),
                          "the index of a body, a time up to state.time and a quaternion of norm 1"});
  for (const SavedState::Rest& rest : saved.rest)
    if (rest.body >= bodies || (rest.asleep_with && *rest.asleep_with >= bodies))
      problems.push_back({"state.rest", std::to_string(rest.body), "indices of bodies"});
    else if (rest.asleep_with && (known.traits[rest.body].kind != BodyKind::Dynamic || rest.steps == 0))
      problems.push_back({"state.rest", std::to_string(rest.body),
                          "a dynamic body that has been at rest for a step or more, where it is asleep"});
  for (const SavedState::Wrench& wrench : saved.wrenches) {
    if (wrench.body >= bodies)
      problems.push_back({"state.wrenches", std::to_string(wrench.body), "the index of a body"});
    checkVector(wrench.force_W, Limits::max_impulse, "state.wrenches.force", "N", problems);
    checkVector(wrench.torque_W, Limits::max_impulse, "state.wrenches.torque", "N m", problems);
    checkVector(wrench.point_B, 2.0 * Limits::max_position, "state.wrenches.point", "m", problems);
    if (!std::isfinite(wrench.until))
      problems.push_back({"state.wrenches.until", text(wrench.until), "a finite time, in s"});
  }
  checkUserForces(saved, bodies, problems);
  return problems;
}

void restoreForces(const SavedState& saved, SceneStore& scene) {
  for (const SavedState::Contact& known : saved.contacts) {
    Contact contact = newContact(scene.bodies, known.a, known.b);
    contact.exact = known.exact, contact.solved = true;
    if (known.touching_steps > 0) contact.touching_from = saved.steps - known.touching_steps + 1;
    for (const SavedState::Contact::Point& point : known.points) {
      SolvedPoint& restored = contact.points.emplace_back();
      restored.feature = point.feature;
      restored.normal = point.normal;
      restored.friction_W = point.tangent_W;
      restored.n_W = known.n_W;
      restored.separation = -known.depth;
    }
    scene.contacts.active.push_back(std::move(contact));
  }
  scene.contacts.endStep([](const Contact&) { return true; });
  for (const SavedState::Wrench& w : saved.wrenches)
    scene.wrenches.push_back(
        {scene.bodies.id[w.body], w.force_W, w.torque_W, w.point_B, w.until, w.commanded});
  scene.time = saved.time;
  scene.steps = saved.steps;
}

void restoreUserForces(const SavedState& saved, SceneStore& scene) {
  Bodies& bodies = scene.bodies;
  for (const SavedState::Frozen& frozen : saved.frozen) {
    Traits& traits = bodies.traits[frozen.body];
    traits.kind = frozen.kinematic ? BodyKind::Kinematic : BodyKind::Dynamic;
    traits.frozen = true;
    bodies.refresh(frozen.body);
  }
  for (const SavedState::Grabbed& grabbed : saved.grabs)
    scene.grabs.push_back({bodies.id[grabbed.body], grabbed.grab});
  for (const SavedState::Held& held : saved.holds) {
    scene.holds.push_back({bodies.id[held.body], held.target});
    bodies.traits[held.body].held = true;
    bodies.twist[held.body] = held.twist;
    bodies.refresh(held.body);
  }
}

bool restoreRotationAndRest(const SavedState& saved, SceneStore& scene) {
  for (const SavedState::Orientation& orientation : saved.orientations) {
    if (!scene.bodies.inertia[orientation.body].lazy_orientation) continue;
    scene.bodies.pose[orientation.body].q_WB = orientation.q_WB;
    scene.bodies.since[orientation.body] = orientation.since;
  }
  if (saved.rest.empty() || !scene.effects[Effect::Sleeping]) return false;
  scene.rest.resize(scene.bodies.size());
  std::map<std::uint32_t, std::vector<Index>> groups;
  for (const SavedState::Rest& rest : saved.rest) {
    scene.rest[rest.body].steps = rest.steps;
    if (rest.asleep_with) groups[*rest.asleep_with].push_back(rest.body);
  }
  for (const auto& [oldest, group] : groups) sleep::putToSleep(scene, group);
  return true;
}

}  // namespace rbs

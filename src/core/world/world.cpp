// SPDX-License-Identifier: BSD-3-Clause
#include "world/world_parts.h"

#include "base/checks.h"
#include "base/text.h"
#include "narrowphase/collide.h"
#include "rigid_body_sim/quote.h"
#include "state/invariants.h"
#include "world/saved_state.h"
#include "world/state_hash.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rbs {

// The first number that no body has. So it follows from the names alone, and a world that is saved and restored goes on alike.
std::string World::Impl::freeName(const Shape& shape, const std::unordered_set<std::string>& taken) {
  const std::string stem = shapeName(shape);
  std::uint64_t& number = numbers_taken[stem];
  std::string name;
  do name = stem + '_' + std::to_string(++number);
  while (taken.count(name) || scene.bodies.indexOf(name) != kNone);
  return name;
}

void World::Impl::nameBodies(std::vector<BodyDef>& bodies) {
  std::unordered_set<std::string> taken;
  for (const BodyDef& body : bodies)
    if (!body.name.empty()) taken.insert(body.name);
  for (BodyDef& body : bodies)
    if (body.name.empty()) body.name = freeName(body.shape, taken);
}

namespace {

void checkNames(const Bodies& bodies, const std::vector<BodyDef>& added, std::vector<Problem>& problems) {
  std::unordered_set<std::string> taken;
  for (std::size_t k = 0; k < added.size(); ++k) {
    const std::string& name = added[k].name;
    if (name.empty() || (bodies.indexOf(name) == kNone && taken.insert(name).second)) continue;
    const std::string path = added.size() == 1 ? "body.name" : "bodies[" + std::to_string(k) + "].name";
    problems.push_back({path, quoted(name), "a name that no other body has"});
  }
}

SceneDef settingsOnly(SceneDef scene) {
  scene.bodies.clear();
  return scene;
}

}  // namespace

World::World(SceneDef scene, const std::optional<SavedState>& saved) : impl_(std::make_unique<Impl>()) {
  throwIfAny(validate(scene));
  std::vector<BodyDef> bodies = std::move(scene.bodies);
  impl_->scene.settings = settingsOnly(std::move(scene));
  impl_->nameBodies(bodies);
  for (const BodyDef& body : bodies) impl_->scene.bodies.append({impl_->next_serial++}, body);
  if (saved) throwIfAny(validate(*saved, impl_->scene.settings, impl_->scene.bodies));
  if (saved) restoreForces(*saved, impl_->scene), restoreUserForces(*saved, impl_->scene);
  impl_->edited(true);
  if (saved && restoreRotationAndRest(*saved, impl_->scene)) impl_->recount();
  impl_->pipeline.filter(impl_->analysis);
}

World::World(const World& other) : impl_(std::make_unique<Impl>(*other.impl_)) {
  impl_->journal = nullptr;
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

// --- bodies

BodyId World::addBody(const BodyDef& body) {
  return addBodies({body}).front();
}

std::vector<BodyId> World::addBodies(const std::vector<BodyDef>& bodies) {
  if (bodies.empty()) return {};
  std::vector<Problem> problems;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::string path = bodies.size() == 1 ? "body" : "bodies[" + std::to_string(k) + "]";
    for (Problem& problem : validate(bodies[k], path)) problems.push_back(std::move(problem));
  }
  checkNames(impl_->scene.bodies, bodies, problems);
  throwIfAny(problems);
  std::vector<BodyDef> named = bodies;
  impl_->nameBodies(named);
  std::vector<BodyId> ids;
  for (const BodyDef& body : named) {
    ids.push_back({impl_->next_serial++});
    impl_->scene.bodies.append(ids.back(), body);
  }
  impl_->edited(true, std::vector<Index>{});
  impl_->record([&] { return commands::AddBodies{named}; });
  return ids;
}

void World::removeBody(BodyId id) {
  const Index i = impl_->require(id);
  impl_->letGo(id);
  SceneStore& scene = impl_->scene;
  const std::string name = scene.bodies.name[i];
  scene.contacts.remove(id);
  scene.wrenches.erase(std::remove_if(scene.wrenches.begin(), scene.wrenches.end(),
                                      [id](const TimedWrench& w) { return w.body == id; }),
                       scene.wrenches.end());
  removeFromAnalysis(scene, i);
  scene.bodies.erase(i);
  impl_->numbers_taken.clear();
  impl_->edited(true, std::vector<Index>{});
  impl_->record([&] { return commands::RemoveBody{name}; });
}

void World::clear() {
  SceneStore& scene = impl_->scene;
  const bool was_empty = scene.bodies.size() == 0;
  scene.bodies.clear();
  scene.wrenches.clear();
  scene.grabs.clear();
  scene.holds.clear();
  scene.contacts = {};
  impl_->numbers_taken.clear();
  const unsigned threads = this->threads();
  impl_->step = {};
  setThreads(threads);
  if (was_empty) return;
  impl_->edited(true);
  impl_->record([] { return commands::Clear{}; });
}

namespace {

Bodies bodyOf(BodyId id, const BodyDef& def) {
  Bodies one;
  one.append(id, def);
  return one;
}

bool isSameBody(const Bodies& a, const Bodies& b) {
  return bodyHash(a, 0) == bodyHash(b, 0) && a.traits[0].density == b.traits[0].density &&
         a.color[0] == b.color[0];
}

}  // namespace

void World::editBody(BodyId id, const BodyEdit& edit) {
  const Index i = impl_->require(id);
  Bodies& bodies = impl_->scene.bodies;
  const std::string name = bodies.name[i];
  BodyDef def = bodies.define(i, impl_->scene.time);
  def.kind = bodies.traits[i].kind;  // also of a frozen body
  const Bodies same = bodyOf(id, def);
  if (edit.mass && edit.density) throw InvalidInput({{"body", "mass and density", "at most one of them"}});
  if (edit.name) def.name = *edit.name;
  if (edit.shape) def.shape = *edit.shape;
  if (edit.pose) def.pose = *edit.pose;
  if (edit.kind) {
    def.kind = *edit.kind;
    if (def.kind != BodyKind::Dynamic) def.twist = {};
  }
  if (edit.twist) def.twist = *edit.twist;
  if (edit.mass || edit.density || edit.shape) {
    def.mass = edit.mass;
    def.density = edit.density;
    if (!edit.mass && !edit.density && bodies.traits[i].density > 0.0) def.density = bodies.traits[i].density;
  }
  if (edit.friction) def.material.friction = *edit.friction;
  if (edit.restitution) def.material.restitution = *edit.restitution;
  if (edit.drag_coefficient) def.material.drag_coefficient = *edit.drag_coefficient;
  if (edit.rolling_resistance) def.material.rolling_resistance = *edit.rolling_resistance;
  if (edit.torsional_resistance) def.material.torsional_resistance = *edit.torsional_resistance;
  if (edit.color) def.color = *edit.color;
  if (edit.group) def.group = *edit.group;
  if (edit.mask) def.mask = *edit.mask;
  std::vector<Problem> problems = validate(def, "body");
  const Index namesake = edit.name ? bodies.indexOf(def.name) : i;
  if (def.name.empty()) {
    problems.push_back({"body.name", "''", "a name"});
  } else if (namesake != i && namesake != kNone) {
    problems.push_back({"body.name", quoted(def.name), "a name that no other body has"});
  }
  throwIfAny(problems);

  const Bodies fresh = bodyOf(id, def);
  const Traits old = bodies.traits[i];
  const bool thaws = old.frozen && (edit.kind || edit.pose);
  if (!thaws && isSameBody(fresh, same)) return;
  bodies.pose[i] = fresh.pose[0];
  bodies.since[i] = impl_->scene.time;
  bodies.twist[i] = fresh.twist[0];
  if (edit.name) bodies.rename(i, *edit.name), impl_->numbers_taken.clear();
  bodies.color[i] = fresh.color[0];
  bodies.traits[i] = fresh.traits[0];
  bodies.traits[i].held = old.held;
  bodies.traits[i].frozen = old.frozen && !thaws;
  bodies.refresh(i);
  // The forces of the last step were those of the body as it was: 1000 N would shoot a feather away.
  if (edit.pose || edit.shape || bodies.traits[i].mass != old.mass) impl_->scene.contacts.forget(id);
  const bool only_motion = !edit.name && !edit.shape && !edit.kind && !edit.mass && !edit.density &&
                           !edit.friction && !edit.restitution && !edit.drag_coefficient &&
                           !edit.rolling_resistance && !edit.torsional_resistance && !edit.color &&
                           !edit.group && !edit.mask && !old.frozen;
  impl_->edited(!only_motion, std::vector<Index>{i});
  impl_->record([&] { return commands::EditBody{name, edit}; });
}

BodyId World::find(const std::string& name) const {
  const Index i = impl_->scene.bodies.indexOf(name);
  return i == kNone ? BodyId{} : impl_->scene.bodies.id[i];
}

// Rises from `clearance` above the origin past every body in the way. Each obstacle lifts the shape by at
// least a hundredth of its size, so the search ends.
Vec3 World::freePlace(const Shape& shape, const Quat& q_WB, double clearance) const {
  const Bodies& bodies = impl_->scene.bodies;
  const double radius = boundingRadius(shape);
  if (!std::isfinite(radius)) return Vec3::Zero();
  Pose pose;
  pose.q_WB = q_WB;
  pose.p_WB.z() = clearance + reach(shape, q_WB.conjugate() * -Vec3::UnitZ());
  const double room = 0.02 * radius;
  for (int tries = 0; tries < 100000; ++tries) {
    double rise = 0.0;
    for (Index i = 0; i < bodies.size(); ++i) {
      const double reach = bodies.traits[i].bounding_radius + radius + room;
      if ((bodies.pose[i].p_WB - pose.p_WB).squaredNorm() > reach * reach) continue;
      const Pose obstacle = bodies.poseNow(i, impl_->scene.time);
      const Manifold manifold = collide(bodies.traits[i].shape, obstacle, shape, pose, room);
      for (int k = 0; k < manifold.size; ++k) rise = std::max(rise, room - manifold.points[k].separation);
    }
    if (rise == 0.0) break;
    pose.p_WB.z() += rise;
  }
  return pose.p_WB;
}

// --- surroundings

// Puts changed settings to the same test as a scene.
template <class Part, class Make>
void World::Impl::change(Part SceneDef::*part, const Part& value, const Make& command) {
  SceneDef settings = scene.settings;
  settings.*part = value;
  throwIfAny(validate(settings));
  if (value == scene.settings.*part) return;
  scene.settings = std::move(settings);
  edited(false);
  record(command);
}

void World::setGravity(const Vec3& gravity_W) {
  impl_->change(&SceneDef::gravity, gravity_W, [&] { return commands::SetGravity{gravity_W}; });
}

// There is no wind without air.
void World::setAir(const std::optional<Air>& air) {
  if (!air) impl_->scene.settings.wind.reset();
  impl_->change(&SceneDef::air, air, [&] { return commands::SetAir{air}; });
}

void World::setWind(const std::optional<Wind>& wind) {
  impl_->change(&SceneDef::wind, wind, [&] { return commands::SetWind{wind}; });
}

void World::setFidelity(const Setting& setting) {
  throwIfAny(validate(setting));
  impl_->scene.settings.fidelity = setting;
  impl_->begunAnew();
  impl_->record([&] { return commands::SetFidelity{setting}; });
}

void World::setGoal(const std::optional<Goal>& goal) {
  if (goal) throwIfAny(validate(*goal));
  impl_->scene.settings.goal = goal;
  impl_->record([&] { return commands::SetGoal{goal}; });
}

void World::setFluid(const std::optional<Fluid>& fluid) {
  impl_->change(&SceneDef::fluid, fluid, [&] { return commands::SetFluid{fluid}; });
}

void World::setEffects(const EffectOverrides& effects) {
  impl_->change(&SceneDef::effects, effects, [&] { return commands::SetEffects{effects}; });
}

// --- journal

void World::setJournal(std::function<void(const Command&)> journal) {
  impl_->journal = std::move(journal);
}

// --- time

void World::setThreads(unsigned threads) {
  if (threads < 1 || threads > 256) throw InvalidInput({{"threads", std::to_string(threads), "1 to 256"}});
  impl_->step.workers->setCount(threads);
}

unsigned World::threads() const {
  return impl_->step.workers->count();
}

void World::Impl::advance(double to) {
  Context context{scene, step, analysis};
  // Where none may meet no stage looks for pairs, and those found before would go on pushing. Sleepers keep theirs.
  if (!scene.effects[Effect::Collision] && analysis.asleep == 0) scene.contacts = {};
  assert(invariants::hold(invariants::broken(scene)));
  const std::int64_t work = step.solve_budget.left;
  double seconds = 0.0;
  std::uint32_t repeated = 0;
  do {
    sleep::wake(scene, step.woken);
    if (!step.woken.empty()) recount();
    step.begin(scene, scene.time, to);
    step.solve_budget.left = work;
    pipeline.run(context);
    seconds += step.report.seconds, repeated += step.report.repeated;
  } while (!step.woken.empty());
  step.report.seconds = seconds, step.report.repeated = repeated;
  assert(invariants::hold(invariants::broken(scene, step)));
  scene.contacts.endStep([this](const Contact& contact) { return scene.isAsleep(contact); });
  scene.time = to;
  scene.just_edited = false;

  // What the step itself has changed is no edit: a copy of the world that runs beside it has taken the step
  // as well.
  std::vector<TimedWrench>& wrenches = scene.wrenches;
  const auto over = [&](const TimedWrench& wrench) { return wrench.until <= scene.time; };
  const auto expired = std::remove_if(wrenches.begin(), wrenches.end(), over);
  const bool some_expired = expired != wrenches.end();
  wrenches.erase(expired, wrenches.end());
  const auto isFrozen = [](const Warning& warning) { return warning.kind == "non_finite"; };
  const bool frozen = std::any_of(step.report.warnings.begin(), step.report.warnings.end(), isFrozen);
  if (frozen) descriptionsChanged();
  for (const std::vector<Index>& group : step.falling_asleep) sleep::putToSleep(scene, group);
  if (some_expired || frozen || !step.falling_asleep.empty()) recount();
}

namespace {

// The share of its weight with which the lighter of two bodies is pushed where they touch: less is what `accurate` leaves.
constexpr double kTouches = 1e-6;

// What the divisions of a step did, together; what it found is that of the last one.
void addDivisions(const StepReport& before, StepReport& report) {
  report.seconds += before.seconds;
  report.overlap_tests += before.overlap_tests;
  report.axis_queries += before.axis_queries;
  report.axes_kept += before.axes_kept;
  report.impacts += before.impacts;
  report.deferred_impacts += before.deferred_impacts;
  report.repeated += before.repeated;
  report.warnings.insert(report.warnings.begin(), before.warnings.begin(), before.warnings.end());
}

}  // namespace

const StepReport& World::step() {
  Impl& w = *impl_;
  const double h = w.scene.settings.step, start = w.scene.time;
  const std::uint32_t parts = w.scene.settings.fidelity.divisions;
  w.step.solve_budget = {kCommonWork};
  if (const auto ms = w.scene.settings.fidelity.max_solve_ms)
    w.step.solve_budget.until =
        std::chrono::steady_clock::now() +
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double, std::milli>(*ms));
  w.scene.contacts.beginWorldStep();
  w.pipeline.restartClocks();
  w.advance(parts == 1 ? start + h : start + h / parts);
  for (std::uint32_t part = 2; part <= parts; ++part) {
    const StepReport before = w.step.report;
    w.step.solve_budget.left = kCommonWork;
    for (Contact& contact : w.scene.contacts.active)
      if (!w.scene.isAsleep(contact)) contact.addEarlier();
    w.advance(part == parts ? start + h : start + h * part / parts);
    addDivisions(before, w.step.report);
  }
  ++w.scene.steps;
  const double least = kTouches * w.scene.gravity_W.norm() * h;
  w.scene.contacts.endWorldStep(w.scene.bodies, w.scene.steps, h, least);
  return w.step.report;
}

}  // namespace rbs

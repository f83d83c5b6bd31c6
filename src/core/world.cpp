#include "rigid_body_sim/world.h"

#include "checks.h"
#include "context.h"
#include "effects/effects.h"
#include "narrowphase/collide.h"
#include "pipeline.h"
#include "saved_state.h"
#include "sleep.h"
#include "state_hash.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace rbs {

// --- the parts behind the interface

struct World::Impl {
  SceneStore scene;
  StepStore step;
  Census census;
  Pipeline pipeline;
  std::uint64_t next_serial = 1;
  std::uint64_t edits = 0;
  std::uint64_t description_version = 0;
  std::unordered_map<std::string, std::uint64_t> next_number;  // of names by shape
  mutable std::shared_ptr<const std::vector<BodyDescription>> descriptions;

  Index require(BodyId id) const {
    const Index i = scene.bodies.indexOf(id);
    if (i == kNone) throw InvalidInput({{"body", std::to_string(id.serial), "a body of this world"}});
    return i;
  }

  // To be called after every edit; `described` when a description changed. `changed` lists the bodies that the edit was
  // about, besides those it appended, where it was about nothing else.
  void edited(bool described, const std::optional<std::vector<Index>>& changed = std::nullopt) {
    ++edits;
    if (described) {
      ++description_version;
      descriptions.reset();
    }
    begunAnew(changed);
  }

  // To be called when what the stages go by has changed.
  void begunAnew(const std::optional<std::vector<Index>>& changed = std::nullopt) {
    const bool some_rest = !scene.rest.empty();
    sleep::wakeAll(scene);
    changed && !some_rest ? adopt(takeCensus(scene, *changed)) : recount();
  }

  void recount() { adopt(takeCensus(scene)); }

  void adopt(Census now) {
    if (now == census) return;
    census = std::move(now);
    pipeline.filter(census);
  }

  // What is known of a body's contacts is void once it has been moved or reshaped.
  void forgetContacts(BodyId id) {
    for (ContactPair& pair : scene.contacts.pairs)
      if (pair.id_i == id || pair.id_j == id) pair.size = 0;
  }

  void letGo(BodyId id) {
    const auto ofBody = [id](const auto& hand) { return hand.body == id; };
    scene.grabs.erase(std::remove_if(scene.grabs.begin(), scene.grabs.end(), ofBody), scene.grabs.end());
    scene.holds.erase(std::remove_if(scene.holds.begin(), scene.holds.end(), ofBody), scene.holds.end());
  }

  void keepContacts();
  void advance(double to);
  std::string freeName(const Shape& shape, const std::unordered_set<std::string>& taken);
  void nameBodies(std::vector<BodyDef>& bodies);
};

// Keeps the touches of this step's solves as the guesses for the next, and those of bodies asleep as they are, and
// drops everything else.
void World::Impl::keepContacts() {
  Contacts kept;
  const auto keep = [&kept](ContactPair pair, const Contacts& from) {
    const auto touches = from.touches.begin() + pair.first;
    pair.first = static_cast<Index>(kept.touches.size());
    kept.touches.insert(kept.touches.end(), touches, touches + pair.size);
    kept.pairs.push_back(pair);
  };
  for (const ContactPair& pair : step.contacts.pairs)
    if (pair.size > 0 && pair.first >= step.inherited) keep(pair, step.contacts);
  if (scene.effects[Effect::Sleeping])
    for (ContactPair pair : scene.contacts.pairs) {
      pair.i = scene.bodies.indexOf(pair.id_i), pair.j = scene.bodies.indexOf(pair.id_j);  // bodies may have gone
      if (pair.size == 0 || pair.i == kNone || pair.j == kNone) continue;
      const Traits &a = scene.bodies.traits[pair.i], &b = scene.bodies.traits[pair.j];
      if ((a.asleep || b.asleep) && !a.moved_by_forces() && !b.moved_by_forces()) keep(pair, scene.contacts);
    }
  std::swap(scene.contacts, kept);
  std::sort(scene.contacts.pairs.begin(), scene.contacts.pairs.end(),
            [](const ContactPair& a, const ContactPair& b) { return a.key() < b.key(); });
}

std::string World::Impl::freeName(const Shape& shape, const std::unordered_set<std::string>& taken) {
  const std::string stem = shapeName(shape);
  std::uint64_t& number = next_number[stem];
  std::string name;
  do name = stem + '_' + std::to_string(++number);
  while (taken.count(name));
  return name;
}

void World::Impl::nameBodies(std::vector<BodyDef>& bodies) {
  std::unordered_set<std::string> taken(scene.bodies.name.begin(), scene.bodies.name.end());
  for (const BodyDef& body : bodies) taken.insert(body.name);
  for (BodyDef& body : bodies) {
    if (!body.name.empty()) continue;
    body.name = freeName(body.shape, taken);
    taken.insert(body.name);
  }
}

namespace {

void checkNames(const Bodies& bodies, const std::vector<BodyDef>& added, std::vector<Problem>& problems) {
  std::unordered_set<std::string> taken(bodies.name.begin(), bodies.name.end());
  for (std::size_t k = 0; k < added.size(); ++k) {
    if (added[k].name.empty() || taken.insert(added[k].name).second) continue;
    const std::string path = added.size() == 1 ? "body.name" : "bodies[" + std::to_string(k) + "].name";
    problems.push_back({path, added[k].name, "a name that no other body has"});
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
  if (saved) throwIfAny(validate(*saved, impl_->scene.bodies.size()));
  if (saved) restoreContacts(*saved, impl_->scene);
  impl_->edited(true);
  if (saved && restoreRotationAndRest(*saved, impl_->scene)) impl_->recount();
  impl_->pipeline.filter(impl_->census);
}

World::World(const World& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

// --- bodies

BodyId World::addBody(const BodyDef& body) {
  return addBodies({body}).front();
}

std::vector<BodyId> World::addBodies(const std::vector<BodyDef>& bodies) {
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
  return ids;
}

void World::removeBody(BodyId id) {
  const Index i = impl_->require(id);
  impl_->letGo(id);
  SceneStore& scene = impl_->scene;
  scene.wrenches.erase(std::remove_if(scene.wrenches.begin(), scene.wrenches.end(),
                                      [id](const TimedWrench& w) { return w.body == id; }),
                       scene.wrenches.end());
  uncountBody(scene, i);
  scene.bodies.erase(i);
  impl_->edited(true, std::vector<Index>{});
}

void World::clear() {
  SceneStore& scene = impl_->scene;
  scene.bodies.clear();
  scene.wrenches.clear();
  scene.grabs.clear();
  scene.holds.clear();
  scene.contacts.clear();
  impl_->edited(true);
}

void World::editBody(BodyId id, const BodyEdit& edit) {
  const Index i = impl_->require(id);
  Bodies& bodies = impl_->scene.bodies;
  BodyDef def = bodies.define(i, impl_->scene.time);
  if (edit.mass && edit.density) throw InvalidInput({{"body", "mass and density", "at most one of them"}});
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
  throwIfAny(validate(def, "body"));

  Bodies fresh;
  fresh.append(id, def);
  bodies.pose[i] = fresh.pose[0];
  bodies.since[i] = impl_->scene.time;
  bodies.twist[i] = fresh.twist[0];
  bodies.color[i] = fresh.color[0];
  const Traits old = bodies.traits[i];
  bodies.traits[i] = fresh.traits[0];
  bodies.traits[i].held = old.held;
  bodies.traits[i].frozen = old.frozen && !edit.kind && !edit.pose;
  bodies.refresh(i);
  // The forces of the last step were those of the body as it was: 1000 N would shoot a feather away.
  if (edit.pose || edit.shape || bodies.traits[i].mass != old.mass) impl_->forgetContacts(id);
  const bool only_motion = !edit.shape && !edit.kind && !edit.mass && !edit.density && !edit.friction &&
                           !edit.restitution && !edit.drag_coefficient && !edit.rolling_resistance &&
                           !edit.torsional_resistance && !edit.color && !old.frozen;
  impl_->edited(!only_motion, std::vector<Index>{i});
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
      const Manifold manifold = collide(bodies.traits[i].shape, bodies.pose[i], shape, pose, room);
      for (int k = 0; k < manifold.size; ++k) rise = std::max(rise, room - manifold.points[k].separation);
    }
    if (rise == 0.0) break;
    pose.p_WB.z() += rise;
  }
  return pose.p_WB;
}

// --- forces

void World::applyImpulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W) {
  const Index i = impl_->require(id);
  Bodies& bodies = impl_->scene.bodies;
  std::vector<Problem> problems;
  checkVector(impulse_W, Limits::max_impulse, "impulse", "N s", problems);
  checkVector(point_W, Limits::max_position, "point", "m", problems);
  if (!bodies.traits[i].movable())
    problems.push_back({"body", bodies.name[i], "a dynamic body that no hand holds"});
  throwIfAny(problems);
  Twist twist = bodies.twist[i];
  twist.v_WB += impulse_W / bodies.traits[i].mass;
  const Pose pose = bodies.poseNow(i, impl_->scene.time);
  const Vec3 couple_B = pose.q_WB.conjugate() * (point_W - pose.p_WB).cross(impulse_W);
  twist.w_WB += pose.q_WB * Vec3(bodies.inertia[i].moments.cwiseInverse().cwiseProduct(couple_B));
  if (twist.v_WB.cwiseAbs().maxCoeff() > Limits::max_speed ||
      twist.w_WB.cwiseAbs().maxCoeff() > Limits::max_spin)
    throw InvalidInput({{"impulse", textOf(impulse_W),
                         "one that leaves the body below " + text(Limits::max_speed) + " m/s and " +
                             text(Limits::max_spin) + " rad/s"}});
  bodies.bringAttitude(i, impl_->scene.time);
  bodies.twist[i] = twist;
  impl_->edited(false, std::vector<Index>{});
}

void World::applyWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                        double seconds) {
  const Index i = impl_->require(id);
  const Bodies& bodies = impl_->scene.bodies;
  std::vector<Problem> problems;
  checkVector(force_W, Limits::max_impulse, "force", "N", problems);
  checkVector(torque_W, Limits::max_impulse, "torque", "N m", problems);
  checkVector(point_W, Limits::max_position, "point", "m", problems);
  checkPositive(seconds, 1e9, "seconds", "s", problems);
  if (!bodies.traits[i].movable())
    problems.push_back({"body", bodies.name[i], "a dynamic body that no hand holds"});
  throwIfAny(problems);
  const Vec3 couple = torque_W + (point_W - bodies.pose[i].p_WB).cross(force_W);
  impl_->scene.wrenches.push_back({id, force_W, couple, impl_->scene.time + seconds});
  impl_->edited(false, std::vector<Index>{i});
}

void World::grab(BodyId id, const Grab& grab) {
  const Index i = impl_->require(id);
  std::vector<Problem> problems;
  checkVector(grab.p_B, Limits::max_position, "grab.p_B", "m", problems);
  checkVector(grab.p_W, Limits::max_position, "grab.p_W", "m", problems);
  checkPositive(grab.frequency, 1e4, "grab.frequency", "Hz", problems);
  checkPositive(grab.max_acceleration, 1e9, "grab.max_acceleration", "m/s^2", problems);
  if (impl_->scene.bodies.traits[i].kind != BodyKind::Dynamic)
    problems.push_back({"body", impl_->scene.bodies.name[i], "a dynamic body"});
  throwIfAny(problems);
  for (HandGrab& hand : impl_->scene.grabs) {
    if (hand.body != id) continue;
    hand.grab = grab;
    ++impl_->edits;
    return;
  }
  release(id);
  impl_->scene.grabs.push_back({id, grab});
  impl_->edited(false, std::vector<Index>{i});
}

void World::hold(BodyId id, const Pose& target) {
  const Index i = impl_->require(id);
  std::vector<Problem> problems;
  checkVector(target.p_WB, Limits::max_position, "hold.position", "m", problems);
  const double norm = target.q_WB.norm();
  if (!(norm > 1e-3 && norm < 1e3))
    problems.push_back({"hold.orientation", text(norm), "a quaternion of norm 1"});
  throwIfAny(problems);
  const Pose unit{target.p_WB, target.q_WB.normalized()};
  for (HandHold& hold : impl_->scene.holds) {
    if (hold.body != id) continue;
    hold.target = unit;
    ++impl_->edits;
    return;
  }
  release(id);
  impl_->scene.holds.push_back({id, unit});
  impl_->scene.bodies.traits[i].held = true;
  impl_->scene.bodies.refresh(i);
  impl_->edited(false, std::vector<Index>{i});
}

void World::release(BodyId id) {
  const Index i = impl_->require(id);
  Bodies& bodies = impl_->scene.bodies;
  impl_->letGo(id);
  if (bodies.traits[i].held) {
    bodies.traits[i].held = false;
    bodies.twist[i] = {};
    bodies.refresh(i);
  }
  impl_->edited(false, std::vector<Index>{i});
}

// --- surroundings

namespace {

// Puts changed settings to the same test as a scene.
SceneDef checked(SceneDef settings) {
  throwIfAny(validate(settings));
  return settings;
}

}  // namespace

void World::setGravity(const Vec3& gravity_W) {
  SceneDef settings = impl_->scene.settings;
  settings.gravity = gravity_W;
  impl_->scene.settings = checked(std::move(settings));
  impl_->edited(false);
}

void World::setAir(const std::optional<Air>& air) {
  SceneDef settings = impl_->scene.settings;
  settings.air = air;
  if (!air) settings.wind.reset();
  impl_->scene.settings = checked(std::move(settings));
  impl_->edited(false);
}

void World::setWind(const std::optional<Wind>& wind) {
  SceneDef settings = impl_->scene.settings;
  settings.wind = wind;
  impl_->scene.settings = checked(std::move(settings));
  impl_->edited(false);
}

void World::setFidelity(const Setting& setting) {
  throwIfAny(validate(setting));
  impl_->scene.settings.fidelity = setting;
  impl_->begunAnew();
}

void World::setGoal(const std::optional<Goal>& goal) {
  if (goal) throwIfAny(validate(*goal));
  impl_->scene.settings.goal = goal;
}

void World::setFluid(const std::optional<Fluid>& fluid) {
  SceneDef settings = impl_->scene.settings;
  settings.fluid = fluid;
  impl_->scene.settings = checked(std::move(settings));
  impl_->edited(false);
}

void World::setEffects(const EffectOverrides& effects) {
  impl_->scene.settings.effects = effects;
  impl_->edited(false);
}

// --- time

void World::Impl::advance(double to) {
  Context context{scene, step, census};
  do {
    sleep::wake(scene, step.woken);
    if (!step.woken.empty()) recount();
    step.begin(scene, scene.time, to);
    pipeline.run(context);
  } while (!step.woken.empty());
  keepContacts();
  scene.time = to;

  std::vector<TimedWrench>& wrenches = scene.wrenches;
  const auto over = [&](const TimedWrench& wrench) { return wrench.until <= scene.time; };
  const auto expired = std::remove_if(wrenches.begin(), wrenches.end(), over);
  const bool frozen = !step.report.warnings.empty();
  if (expired != wrenches.end() || frozen) {
    wrenches.erase(expired, wrenches.end());
    edited(frozen);
  } else if (!step.to_bed.empty()) {
    for (const std::vector<Index>& group : step.to_bed) sleep::putToBed(scene, group);
    recount();
  }
}

namespace {

// What the parts of a step did, together; what it found is that of the last part.
void addParts(const StepReport& before, StepReport& report) {
  report.seconds += before.seconds;
  report.overlap_tests += before.overlap_tests;
  report.impacts += before.impacts;
  report.deferred_impacts += before.deferred_impacts;
  report.warnings.insert(report.warnings.begin(), before.warnings.begin(), before.warnings.end());
}

}  // namespace

const StepReport& World::step() {
  Impl& w = *impl_;
  const double h = w.scene.settings.step, start = w.scene.time;
  const std::uint32_t parts = w.scene.settings.fidelity.divisions;
  w.step.solve_until.reset();
  if (const auto ms = w.scene.settings.fidelity.max_solve_ms)
    w.step.solve_until = std::chrono::steady_clock::now() +
                         std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double, std::milli>(*ms));
  w.pipeline.restartClocks();
  w.advance(parts == 1 ? start + h : start + h / parts);
  for (std::uint32_t part = 2; part <= parts; ++part) {
    const StepReport before = w.step.report;
    w.advance(part == parts ? start + h : start + h * part / parts);
    addParts(before, w.step.report);
  }
  ++w.scene.steps;
  return w.step.report;
}

// --- reading

double World::time() const {
  return impl_->scene.time;
}
std::uint64_t World::steps() const {
  return impl_->scene.steps;
}
std::uint64_t World::edits() const {
  return impl_->edits;
}
const SceneDef& World::scene() const {
  return impl_->scene.settings;
}
std::vector<StageInfo> World::pipeline() const {
  return impl_->pipeline.describe(impl_->census, impl_->scene, impl_->step);
}
std::uint64_t World::stateHash() const {
  return rbs::stateHash(impl_->scene);
}

SceneDef World::capture() const {
  SceneDef scene = impl_->scene.settings;
  for (Index i = 0; i < impl_->scene.bodies.size(); ++i)
    scene.bodies.push_back(impl_->scene.bodies.define(i, impl_->scene.time));
  return scene;
}

SavedState World::captureState() const {
  return rbs::captureState(impl_->scene);
}

Totals World::totals() const {
  const Bodies& bodies = impl_->scene.bodies;
  const Vec3& gravity = impl_->scene.gravity_W;
  Totals sum;
  for (Index i = 0; i < bodies.size(); ++i) {
    const Traits& t = bodies.traits[i];
    if (t.kind != BodyKind::Dynamic || t.frozen) continue;
    const Vec3& p = bodies.pose[i].p_WB;
    const Twist& twist = bodies.twist[i];
    const Vec3 w_B = bodies.pose[i].q_WB.conjugate() * twist.w_WB;
    const Vec3 l_B = bodies.inertia[i].moments.cwiseProduct(w_B);
    sum.kinetic_energy += 0.5 * (t.mass * twist.v_WB.squaredNorm() + l_B.dot(w_B));
    sum.potential_energy -= t.mass * gravity.dot(p);
    sum.momentum += t.mass * twist.v_WB;
    sum.angular_momentum += p.cross(t.mass * twist.v_WB) + bodies.pose[i].q_WB * l_B;
  }
  return sum;
}

Snapshot World::snapshot() const {
  const Impl& w = *impl_;
  const Bodies& bodies = w.scene.bodies;
  Snapshot s;
  s.scene = w.scene.settings.name;
  s.time = w.scene.time;
  s.steps = w.scene.steps;
  s.step = w.scene.settings.step;
  s.edits = w.edits;
  s.description_version = w.description_version;
  if (!w.descriptions) {
    auto fresh = std::make_shared<std::vector<BodyDescription>>();
    for (Index i = 0; i < bodies.size(); ++i) fresh->push_back(bodies.describe(i));
    w.descriptions = std::move(fresh);
  }
  s.bodies = w.descriptions;
  s.states.reserve(bodies.size());
  for (Index i = 0; i < bodies.size(); ++i)
    s.states.push_back({bodies.id[i], bodies.poseNow(i, w.scene.time), bodies.twist[i]});
  for (const ContactPair& pair : w.scene.contacts.pairs) {
    for (Index t = pair.first; t < pair.first + pair.size; ++t) {
      const Touch& touch = w.scene.contacts.touches[t];
      s.contacts.push_back({pair.id_i, pair.id_j, touch.p_W, touch.n_W, touch.separation,
                            touch.normal_impulse, touch.friction_impulse_W});
    }
  }
  s.pipeline = pipeline();
  s.report = w.step.report;
  s.totals = totals();
  const SceneDef& settings = w.scene.settings;
  s.air.air = settings.air.has_value();
  s.air.wind = settings.wind.has_value();
  if (settings.air) s.air.density = settings.air->density;
  if (settings.wind) s.air.mean = settings.wind->velocity, s.air.gust = settings.wind->gust;
  s.air.velocity = airVelocity(settings, w.scene.time);
  s.fluid = settings.fluid;
  s.gravity = settings.gravity;
  s.fidelity = settings.fidelity;
  s.goal = settings.goal;
  s.view = settings.view;
  s.hash = stateHash();
  return s;
}

int Snapshot::find(const std::string& name) const {
  for (std::size_t k = 0; bodies && k < bodies->size(); ++k)
    if ((*bodies)[k].name == name) return static_cast<int>(k);
  return -1;
}

int Snapshot::find(BodyId id) const {
  const auto it = std::lower_bound(states.begin(), states.end(), id,
                                   [](const BodyState& state, BodyId wanted) { return state.id < wanted; });
  return it != states.end() && it->id == id ? static_cast<int>(it - states.begin()) : -1;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// THE table of stages: a step of the world is these rows, in this order. A newcomer starts reading here.
//
// Each row says when the scene needs it; a row that is not needed is not called. islands.advance hands
// islands to the methods: flight for bodies that nothing touches, the soft step or the exact step for bodies
// in contact. What a method does is the second table, solver/inner_step.h; its rows stand below
// islands.advance.
#include "step/pipeline.h"

#include "base/text.h"
#include "broadphase/broad_phase.h"
#include "effects/effects.h"
#include "solver/inner_step.h"
#include "solver/residuals.h"
#include "solver/rolling.h"
#include "step/ballistic.h"
#include "step/contact_states.h"
#include "step/depenetration.h"
#include "step/impacts.h"
#include "step/islands.h"
#include "step/plane_stop.h"
#include "step/sleep.h"
#include "step/step_controller.h"

#include <algorithm>
#include <array>
#include <chrono>

namespace rbs {

namespace {

/// What a stage worked on in the last step.
struct Items {
  std::uint64_t number;
  const char* one;
  const char* many;
  const char* unit() const { return number == 1 ? one : many; }
};

Items bodyItems(std::uint64_t n) {
  return {n, "body", "bodies"};
}
Items pairItems(std::uint64_t n) {
  return {n, "pair", "pairs"};
}

template <Effect kEffect>
Need needOf(const SceneAnalysis& analysis) {
  return effects::need(kEffect, analysis);
}

template <auto kList>
Items bodiesOn(const SceneStore& scene, const StepStore&) {
  return bodyItems((scene.lists.*kList).size());
}
template <Effect kEffect>
Items feeling(const SceneStore& scene, const StepStore&) {
  return bodyItems(scene.lists.feelingOf(kEffect).size());
}
Items candidates(const SceneStore& scene, const StepStore&) {
  return pairItems(scene.contacts.active.size());
}
Items points(const SceneStore&, const StepStore& step) {
  return {step.report.contacts, "point", "points"};
}

std::uint64_t asleep(const SceneStore& scene) {
  std::uint64_t n = 0;
  for (const Traits& t : scene.bodies.traits) n += t.asleep;
  return n;
}

struct Stage {
  const char* name;
  Need (*need)(const SceneAnalysis&);
  void (*run)(Context&);
  Items (*items)(const SceneStore&, const StepStore&);
  std::string (*method)(const SceneStore&) =
      nullptr;  // how it works, where that varies; empty: not known yet
};

constexpr std::array kStages{
    Stage{"user_force.drag", holds::need, holds::run,
          [](const SceneStore& scene, const StepStore&) { return bodyItems(scene.holds.size()); }},
    Stage{"forces.gravity", needOf<Effect::Gravity>, gravity::run,
          [](const SceneStore& scene, const StepStore&) {
            return bodyItems(scene.lists.in_islands.size() + scene.lists.ballistic.size());
          }},
    Stage{"forces.wrench", wrenches::need, wrenches::run,
          [](const SceneStore& scene, const StepStore&) {
            return Items{scene.wrenches.size(), "wrench", "wrenches"};
          }},
    Stage{"forces.buoyancy", needOf<Effect::Buoyancy>, buoyancy::run, feeling<Effect::Buoyancy>},
    Stage{"user_force.spring", grabs::need, grabs::run,
          [](const SceneStore& scene, const StepStore&) { return bodyItems(scene.grabs.size()); }},
    Stage{"forces.drag", needOf<Effect::Drag>, drag::run, feeling<Effect::Drag>},
    Stage{"broadphase.pairs", needOf<Effect::Collision>, broad_phase::findPairs,
          bodiesOn<&BodyLists::collidable>, broad_phase::describe},
    Stage{"sleep.wake", needOf<Effect::Sleeping>, sleep::findWoken,
          [](const SceneStore& scene, const StepStore&) {
            return Items{asleep(scene), "asleep", "asleep"};
          }},
    Stage{"depenetration.find", depenetration::need, depenetration::find, candidates},
    Stage{"contacts.classify", needOf<Effect::Collision>, contact_states::classify, candidates},
    Stage{"impacts.predict", needOf<Effect::Impacts>, impacts::predict, candidates},
    Stage{"islands.build", islands::need, islands::build,
          [](const SceneStore&, const StepStore& step) {
            return Items{step.islands.size(), "island", "islands"};
          }},
    Stage{"islands.advance", islands::need, step_controller::advanceIslands,
          bodiesOn<&BodyLists::in_islands>},
    Stage{"ballistic.integrate", ballistic::need, ballistic::run, bodiesOn<&BodyLists::ballistic>},
    Stage{"depenetration.separate", depenetration::need, depenetration::separate, candidates},
    Stage{"planes.stop", plane_stop::need, plane_stop::run,
          [](const SceneStore& scene, const StepStore&) {
            return Items{scene.lists.planes.size(), "plane", "planes"};
          }},
    Stage{"residuals.check", residuals::need, residuals::check, bodiesOn<&BodyLists::in_islands>},
    Stage{"sleep.update", needOf<Effect::Sleeping>, sleep::update, bodiesOn<&BodyLists::in_islands>},
};

std::string contactLaw(const Setting& setting) {
  const SolverSettings settings = resolved(setting);
  const std::string name =
      std::string(fidelityName(setting.preset)) +
      (setting.divisions > 1 ? " in " + count(setting.divisions, "division", "divisions") : "") + ": ";
  if (settings.exact) return name + "Coulomb's law to " + text(settings.tolerance);
  return name + "soft contacts, " + count(settings.sub_steps, "sub-step", "sub-steps") +
         (settings.promotes ? "; Coulomb's law for small stiff groups" : "");
}

Need needSolver(const SceneAnalysis& analysis) {
  const Need contacts = needOf<Effect::Collision>(analysis);
  return {contacts.active, contacts.active ? contactLaw(analysis.scene.fidelity) : contacts.reason};
}

struct Part {
  const char* name;
  Need (*need)(const SceneAnalysis&);
  Items (*items)(const SceneStore&, const StepStore&);
};

Items frictionPairs(const SceneStore& scene, const StepStore&) {
  std::uint64_t n = 0;
  for (const Contact* contact : scene.contacts.withPoints())
    n += scene.frictionOf(scene.bodies.indexOf(contact->key.i), scene.bodies.indexOf(contact->key.j)) > 0.0;
  return pairItems(n);
}
Items rollingPairs(const SceneStore& scene, const StepStore&) {
  std::uint64_t n = 0;
  for (const Contact* contact : scene.contacts.withPoints())
    n += rolling::resists(scene, scene.bodies.indexOf(contact->key.i), scene.bodies.indexOf(contact->key.j));
  return pairItems(n);
}
Items impactCount(const SceneStore&, const StepStore& step) {
  return {step.report.impacts, "impact", "impacts"};
}
template <bool Inertia::*kFlag>
Items bodiesThat(const SceneStore& scene, const StepStore&) {
  std::uint64_t n = 0;
  for (const Inertia& inertia : scene.bodies.inertia) n += inertia.*kFlag;
  return bodyItems(n);
}
Items turnedBodies(const SceneStore& scene, const StepStore&) {
  std::uint64_t n = 0;
  for (Index i = 0; i < scene.bodies.size(); ++i)
    n += scene.bodies.traits[i].moved_by_forces() && !scene.bodies.inertia[i].lazy_orientation;
  return bodyItems(n);
}

// Parts of islands.advance that a scene may do without: the rows of the inner step, which are timed and come first, and
// effects within them.
constexpr std::array kParts{
    Part{kInnerRowNames[kCollide], needOf<Effect::Collision>, candidates},
    Part{kInnerRowNames[kPrepare], needOf<Effect::Collision>, points},
    Part{kInnerRowNames[kSolve], needSolver, points},
    Part{kInnerRowNames[kIntegrate], islands::need, bodiesOn<&BodyLists::in_islands>},
    Part{kInnerRowNames[kRestitution], needOf<Effect::Restitution>, impactCount},
    Part{kInnerRowNames[kStore], needOf<Effect::Collision>, points},
    Part{"contacts.friction", needOf<Effect::Friction>, frictionPairs},
    Part{"contacts.rolling", needOf<Effect::Rolling>, rollingPairs},
    Part{"rotation.integrate", needOf<Effect::Rotation>, turnedBodies},
    Part{"rotation.gyroscopic", needOf<Effect::Gyroscopic>, bodiesThat<&Inertia::gyroscopic>},
};

// The first of them are timed, by the place of their row.
static_assert(kParts.size() >= kInnerRows);
constexpr bool innerRowsComeFirst() {
  for (std::size_t row = 0; row < kInnerRows; ++row)
    if (kParts[row].name != kInnerRowNames[row]) return false;
  return true;
}
static_assert(innerRowsComeFirst());

using Clock = std::chrono::steady_clock;

double secondsBetween(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

}  // namespace

void Pipeline::filter(const SceneAnalysis& analysis) {
  active_.clear();
  for (std::size_t row = 0; row < kStages.size(); ++row)
    if (kStages[row].need(analysis).active) active_.push_back(row);
  seconds_.resize(kStages.size());
  row_seconds_.resize(kInnerRows);
}

void Pipeline::restartClocks() {
  std::fill(seconds_.begin(), seconds_.end(), 0.0);
  std::fill(row_seconds_.begin(), row_seconds_.end(), 0.0);
}

void Pipeline::run(Context& context) {
  const Clock::time_point begin = Clock::now();
  Clock::time_point mark = begin;
  context.step.row_seconds.assign(kInnerRows, 0.0);
  for (const std::size_t row : active_) {
    kStages[row].run(context);
    const Clock::time_point now = Clock::now();
    seconds_[row] += secondsBetween(mark, now);
    mark = now;
    if (!context.step.woken.empty()) break;  // to be begun again
  }
  for (std::size_t row = 0; row < kInnerRows; ++row) row_seconds_[row] += context.step.row_seconds[row];
  context.step.report.seconds = secondsBetween(begin, mark);
}

std::vector<StageInfo> Pipeline::describe(const SceneAnalysis& analysis, const SceneStore& scene,
                                          const StepStore& step) const {
  std::vector<StageInfo> rows;
  const auto add = [&](const auto& row, double seconds, const char* part_of) {
    const Need need = row.need(analysis);
    const Items items = need.active ? row.items(scene, step) : Items{0, "", ""};
    rows.push_back({row.name, need.active, need.reason, items.number, items.unit(), seconds, part_of});
  };
  for (std::size_t row = 0; row < kStages.size(); ++row) {
    add(kStages[row], seconds_[row], "");
    if (kStages[row].method && rows.back().active)
      if (const std::string method = kStages[row].method(scene); !method.empty())
        rows.back().reason += "; " + method;
    if (kStages[row].run != step_controller::advanceIslands) continue;
    for (std::size_t part = 0; part < kParts.size(); ++part)
      add(kParts[part], part < kInnerRows ? row_seconds_[part] : 0.0, kStages[row].name);
  }
  return rows;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// The ladder of solver settings, and the two goals by which the governor climbs it.
//
// max_error: a copy of the world runs alongside with the settings of the next rung up, and with half its step
// at least: errors of gusts or of free flight go with the step alone, and all rungs of one step share them.
// The deviation d of the two at the end of a window then is at least half the error e of the present rung,
// where that is proportional to the step: d >= e - e/2. So 2 d is taken for the error. When it is above the
// goal, the settings go up a rung. When it is well below, the copy takes the rung below in the next window.
// The error of that is at most its deviation from the present rung and the error of the present rung. The
// settings go there if both together are well below the goal. A rung that was tried in vain is left alone for
// twice as long each time. All decisions go by states, so runs repeat.
//
// max_step_ms: the measure is the mean wall time of the steps of a window. When it is too long, the settings
// go down a rung. When it is far below the goal, they go up a rung, and back if that was too much; the next
// trial then comes after twice as long.
#include "rigid_body_sim/governor.h"

#include "base/cpu_time.h"
#include "base/text.h"
#include "rigid_body_sim/difference.h"
#include "state/fidelity.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs {

namespace {

constexpr double kWindow = 0.25;   // s
constexpr double kOfHalved = 2.0;  // largest error of a run over its deviation from one with half its step
constexpr double kComfort = 0.5;   // share of the goal below which the rung below may do
constexpr double kIdle = 0.3;      // share of the time below which the rung above may do
constexpr std::uint32_t kFirstPatience = 2, kLongestPatience = 64;  // windows

Setting rung(Fidelity preset, std::uint32_t divisions,
             std::optional<std::uint32_t> sub_steps = std::nullopt) {
  Setting setting(preset);
  setting.divisions = divisions;
  setting.sub_steps = sub_steps;
  return setting;
}

const std::array kLadder{rung(Fidelity::Preview, 1),         rung(Fidelity::Interactive, 1),
                         rung(Fidelity::Interactive, 1, 32), rung(Fidelity::Accurate, 1),
                         rung(Fidelity::Accurate, 2),        rung(Fidelity::Accurate, 4),
                         rung(Fidelity::Reference, 4),       rung(Fidelity::Reference, 8)};

Setting halved(Setting setting) {
  setting.divisions = std::min<std::uint32_t>(2 * setting.divisions, Limits::max_divisions);
  return setting;
}

// Whether a is at least as exact as b in each of its numbers.
bool isAsExact(const Setting& a, const Setting& b) {
  const SolverSettings x = resolved(a), y = resolved(b);
  return a.preset >= b.preset && a.divisions >= b.divisions && (x.exact || x.sub_steps >= y.sub_steps) &&
         (!y.exact || x.tolerance <= y.tolerance);
}

bool isMoreExact(const Setting& a, const Setting& b) {
  return isAsExact(a, b) && !isAsExact(b, a);
}

// The next rung that is more exact than a setting, which need not be a rung itself. Null: there is none.
const Setting* above(const Setting& setting) {
  for (const Setting& rung : kLadder)
    if (isMoreExact(rung, setting)) return &rung;
  return nullptr;
}

// The last rung that is less exact.
const Setting* below(const Setting& setting) {
  for (auto rung = kLadder.rbegin(); rung != kLadder.rend(); ++rung)
    if (isMoreExact(setting, *rung)) return &*rung;
  return nullptr;
}

}  // namespace

struct Governor::Impl {
  bool estimating = false;
  std::optional<World> beside;
  std::uint64_t edits = 0;                  // of the world when the window began
  Setting setting;                          // of the world when the window began
  std::optional<Goal> goal;                 // that patience was learned with
  std::uint32_t steps = 0;                  // of the window so far
  double seconds = 0.0;                     // wall time of these, of the world
  double beside_seconds = 0.0;              // and of the one beside it
  bool tries_below = false;                 // beside it runs the rung below
  double error = 0.0;                       // of the present settings in the window before, m/s
  std::uint32_t calm = 0;                   // windows since the last trial or turn
  std::uint32_t patience = kFirstPatience;  // windows to be calm before the next trial
  std::optional<ErrorEstimate> estimate;
  // Of this goal. Every new reason is logged, so that of a goal which is out of reach holds no measurement.
  std::string reason;
  double step_cpu_seconds = 0.0;

  const StepReport& stepWorld(World& world) {
    const double start = threadCpuSeconds();
    const StepReport& report = world.step();
    step_cpu_seconds = threadCpuSeconds() - start;
    return report;
  }

  void begin(const World& world) {
    if (world.edits() != edits || world.scene().fidelity != setting) tries_below = false;
    edits = world.edits();
    setting = world.scene().fidelity;
    steps = 0;
    seconds = beside_seconds = 0.0;
    beside.reset();
    if (!(goal == world.scene().goal))
      goal = world.scene().goal, patience = kFirstPatience, calm = 0, tries_below = false, reason.clear();
    const bool wants_error = goal && goal->max_error;
    if (!wants_error && !estimating) {
      estimate.reset();
      return;
    }
    Setting other = halved(setting);
    if (wants_error) {
      if (tries_below) {
        other = *below(setting);
      } else if (const Setting* next = above(setting)) {
        const std::uint32_t divisions = std::max(next->divisions, other.divisions);
        other = *next;
        other.divisions = divisions;
      }
    }
    beside.emplace(world);
    beside->setFidelity(other);
  }

  void change(World& world, const Setting& to, const std::string& why) {
    reason = settingName(to) + ": " + why;
    world.setFidelity(to);
    calm = 0;
  }

  // Deviation of the two runs over the window.
  ErrorEstimate deviation(const World& world) const {
    const double window = steps * world.scene().step;
    const Difference difference = differenceOf(world.snapshot(), beside->snapshot());
    return {{difference.distance / window, difference.angle / window, difference.energy / window},
            window,
            world.scene().fidelity,
            beside->scene().fidelity,
            1e3 * beside_seconds / steps};
  }

  void seekError(World& world, double most) {
    const Setting now = world.scene().fidelity;
    const std::string goal = text(1e3 * most) + " mm/s";
    if (tries_below) {
      tries_below = false;
      calm = 0;
      const double of_below = deviation(world).error.distance + error;
      if (of_below <= kComfort * most) {
        patience = kFirstPatience;
        return change(world, *below(now),
                      "its error of " + text(1e3 * of_below) + " mm/s is well below " + goal);
      }
      patience = std::min(2 * patience, kLongestPatience);
      return;
    }
    estimate = deviation(world);
    error = kOfHalved * estimate->error.distance;
    if (error > most) {
      patience = std::min(2 * patience, kLongestPatience);
      if (const Setting* next = above(now))
        change(world, *next,
               settingName(now) + " has an error of " + text(1e3 * error) + " mm/s, which is above " + goal);
      else
        reason = settingName(now) + ": the most accurate settings, although their error exceeds " + goal;
    } else if (++calm >= patience && below(now)) {
      tries_below = true;
    }
  }

  void seekTime(World& world, double most) {
    const Setting now = world.scene().fidelity;
    const double ms = 1e3 * seconds / steps;
    const std::string goal = text(most) + " ms";
    const auto took = [&](const char* where) {
      return settingName(now) + " takes " + text(ms) + " ms a step, which is " + where + " " + goal;
    };
    if (ms > most) {
      patience = std::min(2 * patience, kLongestPatience);
      calm = 0;
      if (const Setting* next = below(now))
        change(world, *next, took("above"));
      else
        reason =
            settingName(now) + ": the fastest settings, although they take more than " + goal + " a step";
    } else if (++calm >= patience && ms < kIdle * most && above(now)) {
      change(world, *above(now), took("far below"));
    }
  }
};

Governor::Governor() : impl_(std::make_unique<Impl>()) {}
Governor::~Governor() = default;
Governor::Governor(Governor&&) noexcept = default;
Governor& Governor::operator=(Governor&&) noexcept = default;

const StepReport& Governor::step(World& world) {
  Impl& g = *impl_;
  const std::optional<Goal>& goal = world.scene().goal;
  if (!goal && !g.estimating) {
    g.beside.reset();
    g.estimate.reset();
    g.goal.reset();
    return g.stepWorld(world);
  }
  const bool wants_beside = g.estimating || goal->max_error;
  const bool changed = world.edits() != g.edits || world.scene().fidelity != g.setting;
  if (changed || g.steps == 0 || wants_beside != g.beside.has_value() || !(goal == g.goal)) g.begin(world);

  const StepReport& report = g.stepWorld(world);
  g.seconds += report.seconds;
  if (g.beside) g.beside_seconds += g.beside->step().seconds;
  ++g.steps;
  if (world.edits() != g.edits || g.steps * world.scene().step < kWindow * (1.0 - 1e-9)) return report;

  if (goal && goal->max_error)
    g.seekError(world, *goal->max_error);
  else if (g.beside)
    g.estimate = g.deviation(world);
  if (goal && goal->max_step_ms) g.seekTime(world, *goal->max_step_ms);
  g.steps = 0;
  return report;
}

void Governor::setEstimating(bool on) {
  impl_->estimating = on;
}
const std::optional<ErrorEstimate>& Governor::estimate() const {
  return impl_->estimate;
}
std::string Governor::reason(const World& world) const {
  const std::optional<Goal>& goal = world.scene().goal;
  return goal && goal == impl_->goal ? impl_->reason : "";
}
double Governor::stepCpuSeconds() const {
  return impl_->step_cpu_seconds;
}

}  // namespace rbs

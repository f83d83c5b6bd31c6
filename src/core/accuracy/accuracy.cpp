// SPDX-License-Identifier: BSD-3-Clause
// The schedule of an accuracy study: it has an answer early, and a better one the longer it runs.
//
// The first window begins at the present state and grows: 1, 2, 4, ... steps, compared each time. So the
// first answer takes one step of each choice of settings and of the reference. Growing a window to its full
// length costs no more than running it at once. In a chaotic scene a difference d grows as d exp(t/T), with T
// the Lyapunov time. The difference of the reference from its own half step starts at rounding, or at a
// collision that the two order differently. It outgrows the error of the settings, which starts at the
// truncation error of a step. So a window is measured in pieces: each is as long as the reference still
// converges (accuracy_window.cpp), and the next begins where the reference has ended it. Lengths differ by a
// factor of two. A piece of one step counts in any case: what nobody can predict is not left out, since it
// is there that settings differ most. A window that would cost more than a fraction of the CPU time ends at
// the length that it has reached.
//
// Then each choice of settings runs alone through all of the physics time, to measure its CPU time: a pile
// that collapses at `preview` has the cost of the collapse. The other windows come last. Their order is not
// that of time: the finished windows are spread evenly along the path, whenever the study is ended. As few
// worlds are kept at a time, a sweep along all of the path passes the beginnings of some windows, and later
// sweeps those between them.
#include "rigid_body_sim/accuracy.h"

#include "accuracy/accuracy_window.h"
#include "base/checks.h"
#include "base/cpu_time.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace rbs {

namespace {

constexpr std::uint32_t kMostWindowSteps = 1000;
/// Largest number of initial worlds of windows that are stored at a time.
constexpr std::uint32_t kKept = 16;
/// Largest fractions of the CPU time: of all of it for one window and for the timed runs, of the rest for
/// each part of the path.
constexpr double kWindowShare = 0.125, kTimingShare = 0.25, kPathShare = 0.25;
/// Short runs are repeated, and the fastest counts, s.
constexpr double kShortRun = 5e-3;
constexpr int kRepetitions = 3;
/// CPU time of timed steps between two looks at the clock, which takes as long as a cheap step, s.
constexpr double kBetweenLooks = 1e-4;

/// 0 to n - 1, each as far as can be from those before it: 0, n/2, then the quarters, and so on.
std::vector<std::size_t> spread(std::size_t n) {
  std::vector<std::size_t> order;
  std::size_t power = 1;
  while (power < n) power *= 2;
  for (std::size_t k = 0; k < power; ++k) {
    std::size_t reversed = 0;
    for (std::size_t bit = 1; bit < power; bit *= 2) reversed = 2 * reversed + ((k & bit) != 0);
    if (reversed < n) order.push_back(reversed);
  }
  return order;
}

/// Sums over the pieces of windows so far.
struct Sums {
  WindowSum errors;
  std::uint32_t inconclusive = 0, shortest = 0;  // pieces; length in steps
  std::uint64_t steps = 0;
  std::vector<double> seconds;  // CPU time of each setting

  // A piece of which `reading` counts, and whose runs have taken so many steps.
  void add(const AccuracyWindow& piece, const WindowReading& reading, std::uint32_t taken, double step) {
    errors.add(reading, step);
    if (!reading.converged) ++inconclusive;
    shortest = shortest == 0 ? reading.steps : std::min(shortest, reading.steps);
    steps += taken;
    for (std::size_t k = 0; k < seconds.size(); ++k) seconds[k] += piece.secondsOf(k);
  }
};

/// CPU time of the runs of one setting alone.
struct Timing {
  double seconds = 0.0;
  std::uint64_t steps = 0;  ///< 0: not timed
};

/// Why there is no reference for a world. Without located impacts the exact step has no law of rebound, so
/// bodies with restitution lie still in every reference.
std::string withoutReference(const World& world) {
  const Snapshot snapshot = world.snapshot();
  const auto isOff = [&](Effect effect) {
    const auto forced = snapshot.effects.find(effect);
    return forced != snapshot.effects.end() && !forced->second;
  };
  const bool rebounds =
      !isOff(Effect::Collision) && !isOff(Effect::Restitution) &&
      std::any_of(snapshot.bodies->begin(), snapshot.bodies->end(),
                  [](const BodyDescription& body) { return body.material.restitution > 0.0; });
  return rebounds && isOff(Effect::Impacts)
             ? "the effect impacts is off, without which the reference has no restitution"
             : "";
}

/// Thrown inside to end a study.
struct Stopped {};

class Study {
 public:
  Study(const World& world, const AccuracyOptions& options,
        const std::function<bool(double, const AccuracyStudy&)>& goOn)
      : options_(options), goOn_(goOn), start_(world), path_(world), begin_(threadCpuSeconds()) {
    start_.setGoal(std::nullopt);
    start_.setFidelity(Fidelity::Reference);
    step_ = world.scene().step;
    const double steps = std::round(options.window / step_);
    window_steps_ = static_cast<std::uint32_t>(std::clamp(steps, 1.0, static_cast<double>(kMostWindowSteps)));
    path_steps_ = static_cast<std::uint64_t>(std::max(1.0, std::round(options.seconds / step_)));
    order_ = spread(std::min<std::uint64_t>(options.windows, path_steps_));
    result_.scene = world.scene().name;
    result_.time = world.time();
    result_.step = step_;
    result_.window = window_steps_ * step_;
    result_.seconds = options.seconds;
    for (const Setting& setting : options.settings.empty() ? usualSettings() : options.settings) {
      result_.settings.emplace_back();
      result_.settings.back().setting = setting;
    }
    sums_.seconds.resize(result_.settings.size());
    timings_.resize(result_.settings.size());
    smallest_ = std::numeric_limits<double>::infinity();
    for (const BodyDescription& body : *world.snapshot().bodies)
      if (body.kind == BodyKind::Dynamic) smallest_ = std::min(smallest_, boundingRadius(body.shape));
  }

  AccuracyStudy run() {
    if (!std::isfinite(smallest_)) {
      result_.trouble = "the scene has no dynamic body";
      return result_;
    }
    if (const std::string why = withoutReference(start_); !why.empty()) {
      result_.trouble = why;
      return result_;
    }
    try {
      measureWindow(start_);
      timeRuns();
      while (done_ < order_.size()) {
        const std::map<std::size_t, World> begins = followPath();
        for (const std::size_t window : order_)
          if (const auto found = begins.find(window); found != begins.end()) measureWindow(found->second);
      }
      result_.complete = !cut_;
    } catch (const Stopped&) {
    }
    if (result_.first_answer == 0.0)
      result_.trouble = "the CPU time of " + text(spent()) +
                        " s ended before each choice of solver settings had taken one step";
    return result_;
  }

 private:
  double spent() const { return threadCpuSeconds() - begin_; }

  // Ends the study where its CPU time is over or goOn_ returns false.
  void checkIn() {
    const double share = std::max(static_cast<double>(done_) / static_cast<double>(order_.size()),
                                  spent() / options_.max_cpu_seconds);
    if (!goOn_(std::min(1.0, share), result_) || share > 1.0) throw Stopped{};
  }

  void advance(World& world) {
    world.step();
    checkIn();
  }

  // The initial worlds of the next windows, by their numbers: at most kKept, fewer where the path is expensive.
  std::map<std::size_t, World> followPath() {
    if (sweep_.empty()) {
      const auto next = order_.begin() + static_cast<std::ptrdiff_t>(done_);
      sweep_.assign(next, next + std::min<std::ptrdiff_t>(kKept, order_.end() - next));
      std::sort(sweep_.begin(), sweep_.end(), std::greater<>());
      path_ = World(start_);
      on_path_ = 0;
    }
    const double until = spent() + kPathShare * (options_.max_cpu_seconds - spent());
    std::map<std::size_t, World> begins;
    for (; !sweep_.empty(); sweep_.pop_back()) {
      const double share = static_cast<double>(sweep_.back()) / static_cast<double>(order_.size());
      const auto begin = static_cast<std::uint64_t>(std::round(share * static_cast<double>(path_steps_)));
      for (; on_path_ < begin; ++on_path_) {
        if (!begins.empty() && spent() > until) return begins;
        advance(path_);
      }
      begins.emplace(sweep_.back(), path_);
    }
    return begins;
  }

  // A window, in as many pieces as it takes.
  void measureWindow(const World& begin) {
    World from(begin);
    std::uint32_t left = window_steps_, pieces = 0;
    double seconds = 0.0;
    bool expensive = false;
    while (left > 0 && !expensive) {
      AccuracyWindow piece(from, result_.settings, smallest_);
      WindowReading best;
      for (std::uint32_t steps = 1;; steps = std::min(2 * steps, left)) {
        const WindowReading reading = piece.growTo(steps, [this](World& world) { advance(world); });
        if (steps == 1 || reading.converged) {
          best = reading;
          from = World(piece.reference());
        }
        expensive = 2.0 * (seconds + piece.seconds()) > kWindowShare * options_.max_cpu_seconds;
        Sums sums = sums_;
        sums.add(piece, best, steps, step_);
        write(sums, done_ + 1, shortened_ + (best.steps < window_steps_));
        // Once it has parted from its half step, the reference does not come back.
        if (steps < left && !expensive && reading.converged) continue;
        sums_ = std::move(sums);
        break;
      }
      seconds += piece.seconds();
      left -= best.steps;
      ++pieces;
    }
    cut_ = cut_ || left > 0;
    shortened_ += pieces > 1 || left > 0;
    ++done_;
  }

  void write(const Sums& sums, std::uint32_t windows, std::uint32_t shortened) {
    if (result_.first_answer == 0.0) result_.first_answer = spent();
    sums.errors.write(result_);
    result_.windows = windows;
    result_.shortened = shortened;
    result_.inconclusive = sums.inconclusive;
    result_.shortest = sums.shortest * step_;
    for (std::size_t k = 0; k < timings_.size(); ++k) {
      const Timing timing = timings_[k].steps > 0 ? timings_[k] : Timing{sums.seconds[k], sums.steps};
      result_.settings[k].steps = timing.steps;
      result_.settings[k].step_ms = 1e3 * timing.seconds / static_cast<double>(timing.steps);
    }
  }

  // Times a run of each choice of settings from the present state through all of `seconds`. Settings that do
  // not reach the end are timed by the windows.
  void timeRuns() {
    const double end = spent() + kTimingShare * options_.max_cpu_seconds;
    for (std::size_t k = 0; k < timings_.size(); ++k) {
      const double until = spent() + (end - spent()) / static_cast<double>(timings_.size() - k);
      double least = std::numeric_limits<double>::infinity();
      for (int run = 0; run < kRepetitions && (run == 0 || least < kShortRun); ++run)
        least = std::min(least, timeRun(result_.settings[k].setting, until));
      if (std::isfinite(least)) timings_[k] = {least, path_steps_};
      write(sums_, done_, shortened_);
    }
  }

  // CPU time of a run, s; infinite where it is not through at `until`.
  double timeRun(const Setting& setting, double until) {
    World world(start_);
    world.setFidelity(setting);
    double sum = 0.0;
    for (std::uint64_t taken = 0, together = 1; taken < path_steps_;) {
      const double start = spent();
      if (start > until) return std::numeric_limits<double>::infinity();
      const std::uint64_t end = std::min(taken + together, path_steps_);
      for (; taken < end; ++taken) world.step();
      const double seconds = spent() - start;
      sum += seconds;
      together = seconds < kBetweenLooks ? 2 * together : std::max<std::uint64_t>(1, together / 2);
      checkIn();
    }
    return sum;
  }

  const AccuracyOptions& options_;
  const std::function<bool(double, const AccuracyStudy&)>& goOn_;
  World start_, path_;
  const double begin_;
  double step_ = 0.0, smallest_ = 0.0;
  std::uint32_t window_steps_ = 1;
  std::uint64_t path_steps_ = 1, on_path_ = 0;
  std::vector<std::size_t> order_, sweep_;  // of the windows: all, and those ahead on this sweep, last first
  std::uint32_t done_ = 0, shortened_ = 0;  // windows
  bool cut_ = false;                        // a window was too expensive for its full length
  Sums sums_;
  std::vector<Timing> timings_;
  AccuracyStudy result_;
};

}  // namespace

std::vector<Setting> usualSettings() {
  std::vector<Setting> settings;
  const auto add = [&](Fidelity preset, std::uint32_t divisions) {
    settings.emplace_back(preset);
    settings.back().divisions = divisions;
  };
  for (const std::uint32_t divisions : {1, 2, 4}) add(Fidelity::Preview, divisions);
  for (const std::uint32_t divisions : {1, 2, 4}) add(Fidelity::Interactive, divisions);
  for (const std::uint32_t sub_steps : {16, 32}) {
    add(Fidelity::Interactive, 1);
    settings.back().sub_steps = sub_steps;
  }
  add(Fidelity::Accurate, 1);
  settings.back().tolerance = 1e-3;
  for (const std::uint32_t divisions : {1, 2}) add(Fidelity::Accurate, divisions);
  for (const std::uint32_t divisions : {1, 2}) add(Fidelity::Reference, divisions);
  return settings;
}

std::vector<Problem> validate(const AccuracyOptions& options) {
  std::vector<Problem> problems;
  const auto check = [&](const char* name, double value, double low, double high, const char* unit) {
    if (!(value >= low && value <= high))
      problems.push_back({name, text(value), text(low) + " to " + text(high) + unit});
  };
  check("seconds", options.seconds, 1e-6, 1000.0, " s");
  check("window", options.window, 1e-6, 1000.0, " s");
  check("windows", options.windows, 1, 1000, "");
  check("max_cpu_seconds", options.max_cpu_seconds, 1e-3, 1e6, " s");
  for (const Setting& setting : options.settings)
    for (Problem& problem : validate(setting)) problems.push_back(std::move(problem));
  return problems;
}

AccuracyStudy measureAccuracy(const World& world, const AccuracyOptions& options,
                              const std::function<bool(double, const AccuracyStudy&)>& goOn) {
  throwIfAny(validate(options));
  return Study(world, options, goOn).run();
}

const SettingCost* cheapestWithin(const AccuracyStudy& study, double max_error) {
  const SettingCost* best = nullptr;
  if (!study.trouble.empty()) return best;
  for (const SettingCost& cost : study.settings)
    if (cost.error.distance <= max_error && (!best || cost.step_ms < best->step_ms)) best = &cost;
  return best;
}

const SettingCost* mostAccurateWithin(const AccuracyStudy& study, double max_step_ms) {
  // A bound e + u of at most 2 u is that of an e within u, which may be no error at all. Such settings are
  // equally good, and the cheaper the better.
  const double least = 2.0 * study.uncertainty.distance;
  const auto rank = [&](const SettingCost& cost) {
    return std::pair(std::max(cost.error.distance, least), cost.step_ms);
  };
  const SettingCost* best = nullptr;
  if (!study.trouble.empty()) return best;
  for (const SettingCost& cost : study.settings)
    if (cost.step_ms <= max_step_ms && (!best || rank(cost) < rank(*best))) best = &cost;
  return best;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Each window: from one state of the path, every setting and the truth run for the same time, and their ends are
// compared. How well the truth itself is known is what halving its step changes, u: an error below u is a bound, and a
// window where u is not below the errors that are to be told apart says nothing.
//
// Up to sixteen windows are not taken in the order of time but so that those that are done lie evenly along the path,
// whenever the study is ended.
#include "rigid_body_sim/accuracy.h"

#include "checks.h"
#include "text.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

namespace rbs {

namespace {

constexpr std::uint32_t kTruthDivisions = 8;
constexpr std::uint32_t kMostWindowSteps = 1000;
/// How far apart the truth and its half may be: a share of the largest error of the window, or of the smallest body.
constexpr double kTruthShare = 0.1, kTruthSize = 1e-6;
/// Worlds that windows begin with which are kept at a time.
constexpr std::uint32_t kKept = 16;
/// Share of the time that the path of the first of them may take: a dearer one is cut short.
constexpr double kPathShare = 0.25;
/// Short runs are repeated, and the fastest counts.
constexpr double kShortRun = 5e-3;
constexpr int kRepetitions = 3;

/// 0 to n - 1, each as far as can be from those before it: n/2 after 0, then the quarters, and so on.
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

Setting referenceIn(std::uint32_t divisions) {
  Setting setting(Fidelity::Reference);
  setting.divisions = divisions;
  return setting;
}

/// CPU time of this thread, s.
double cpuNow() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

ErrorRate rateOf(const Difference& difference, double seconds) {
  return {difference.distance / seconds, difference.angle / seconds, difference.energy / seconds};
}

template <class Pick>
void combine(ErrorRate& rate, const ErrorRate& other, Pick pick) {
  rate.distance = pick(rate.distance, other.distance);
  rate.angle = pick(rate.angle, other.angle);
  rate.energy = pick(rate.energy, other.energy);
}

/// Thrown inside to end a study.
struct Stopped {};

class Study {
 public:
  Study(const World& world, const AccuracyOptions& options,
        const std::function<bool(double, const AccuracyStudy&)>& goOn)
      : options_(options), goOn_(goOn), path_(world), begin_(cpuNow()) {
    path_.setGoal(std::nullopt);
    path_.setFidelity(Fidelity::Reference);
    step_ = world.scene().step;
    const double steps = std::round(options.window / step_);
    window_steps_ = static_cast<std::uint32_t>(std::clamp(steps, 1.0, static_cast<double>(kMostWindowSteps)));
    result_.scene = world.scene().name;
    result_.time = world.time();
    result_.step = step_;
    result_.window = window_steps_ * step_;
    result_.seconds = options.seconds;
    for (const Setting& setting : options.settings.empty() ? usualSettings() : options.settings) {
      result_.settings.emplace_back();
      result_.settings.back().setting = setting;
    }
    smallest_ = std::numeric_limits<double>::infinity();
    for (const BodyDescription& body : *world.snapshot().bodies)
      if (body.kind == BodyKind::Dynamic) smallest_ = std::min(smallest_, boundingRadius(body.shape));
  }

  AccuracyStudy run() {
    if (!std::isfinite(smallest_)) {
      result_.trouble = "nothing moves in this scene";
      return result_;
    }
    try {
      std::uint32_t done = 0;
      for (bool cut = false; done < options_.windows && !cut;) {
        const std::vector<World> begins = followPath(done);
        for (const std::size_t k : spread(begins.size())) measureWindow(begins[k]);
        cut = begins.size() < std::min(kKept, options_.windows - done);
        done += static_cast<std::uint32_t>(begins.size());
      }
      result_.complete = done == options_.windows;
    } catch (const Stopped&) {
    }
    explain();
    return result_;
  }

 private:
  // The worlds that the windows from `first` on begin with: as many as are kept, or fewer where the path is too dear.
  std::vector<World> followPath(std::uint32_t first) {
    std::vector<World> begins;
    for (std::uint32_t k = first; k < options_.windows && begins.size() < kKept; ++k) {
      const auto begin = static_cast<std::uint64_t>(std::round(options_.seconds * k / options_.windows / step_));
      for (; on_path_ < begin; ++on_path_) {
        if (first == 0 && cpuNow() - begin_ > kPathShare * options_.max_cpu_seconds) return begins;
        advance(path_);
      }
      begins.push_back(path_);
    }
    return begins;
  }

  // Steps, and what is left of the study's time with it.
  void advance(World& world) {
    world.step();
    const double spent = cpuNow() - begin_;
    if (spent > options_.max_cpu_seconds || !goOn_(share(spent), result_)) throw Stopped{};
  }

  double share(double spent) const {
    const double windows = result_.windows + result_.dropped;
    return std::min(1.0, std::max(windows / options_.windows, spent / options_.max_cpu_seconds));
  }

  struct Run {
    Snapshot end;
    double seconds;  // CPU time of its steps
  };

  Run runWindow(const World& from, const Setting& setting) {
    World world(from);
    world.setFidelity(setting);
    const double start = cpuNow();
    for (std::uint32_t k = 0; k < window_steps_; ++k) advance(world);
    Run run{{}, cpuNow() - start};
    run.end = world.snapshot();
    return run;
  }

  void measureWindow(const World& from) {
    std::vector<Run> runs;
    for (const SettingCost& cost : result_.settings) {
      runs.push_back(runWindow(from, cost.setting));
      for (int k = 1; k < kRepetitions && runs.back().seconds < kShortRun; ++k)
        runs.back().seconds = std::min(runs.back().seconds, runWindow(from, cost.setting).seconds);
    }
    const Snapshot half = runWindow(from, referenceIn(kTruthDivisions / 2)).end;
    const Snapshot truth = runWindow(from, referenceIn(kTruthDivisions)).end;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      SettingCost& cost = result_.settings[k];
      cost.step_ms = (cost.step_ms * static_cast<double>(cost.steps) + 1e3 * runs[k].seconds) /
                     static_cast<double>(cost.steps + window_steps_);
      cost.steps += window_steps_;
    }

    const Difference doubt = differenceOf(half, truth);
    std::vector<Difference> errors;
    double largest = 0.0;
    for (const Run& run : runs) {
      errors.push_back(differenceOf(run.end, truth));
      largest = std::max(largest, errors.back().distance);
    }
    if (doubt.distance > std::max(kTruthShare * largest, kTruthSize * smallest_)) {
      ++result_.dropped;
      dropped_doubt_ = std::max(dropped_doubt_, doubt.distance);
      return;
    }
    const double n = ++result_.windows;
    const auto mean = [n](double sum, double x) { return sum + (x - sum) / n; };
    const auto larger = [](double a, double b) { return std::max(a, b); };
    combine(result_.uncertainty, rateOf(doubt, result_.window), mean);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      SettingCost& cost = result_.settings[k];
      const ErrorRate rate = rateOf(errors[k], result_.window);
      combine(cost.error, rate, mean);
      combine(cost.worst, rate, larger);
      cost.at_most = cost.error.distance <= result_.uncertainty.distance;
    }
  }

  void explain() {
    if (result_.windows > result_.dropped) return;
    if (result_.dropped > 0)
      result_.trouble = "the reference did not converge in " + std::to_string(result_.dropped) + " of " +
                        std::to_string(result_.dropped + result_.windows) + " windows of " + text(result_.window) +
                        " s: halving its step moves a body by up to " + text(dropped_doubt_) + " m; a shorter window may do";
    else
      result_.trouble = "not one window of " + text(result_.window) + " s was done in " + text(options_.max_cpu_seconds) +
                        " s of CPU time: allow more, or take a shorter window";
  }

  const AccuracyOptions& options_;
  const std::function<bool(double, const AccuracyStudy&)>& goOn_;
  World path_;
  const double begin_;
  double step_ = 0.0, smallest_ = 0.0, dropped_doubt_ = 0.0;
  std::uint32_t window_steps_ = 1;
  std::uint64_t on_path_ = 0;  // steps
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
    if (!(value >= low && value <= high)) problems.push_back({name, text(value), text(low) + " to " + text(high) + unit});
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
  // What is below the doubt about the truth is equally good, and the cheaper the better.
  const auto rank = [&](const SettingCost& cost) {
    return std::pair(std::max(cost.error.distance, study.uncertainty.distance), cost.step_ms);
  };
  const SettingCost* best = nullptr;
  if (!study.trouble.empty()) return best;
  for (const SettingCost& cost : study.settings)
    if (cost.step_ms <= max_step_ms && (!best || rank(cost) < rank(*best))) best = &cost;
  return best;
}

}  // namespace rbs

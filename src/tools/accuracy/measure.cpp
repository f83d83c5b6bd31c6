// SPDX-License-Identifier: BSD-3-Clause
#include "measure.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

namespace rbs::accuracy {
namespace {

/// CPU seconds of this thread.
double cpuNow() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

bool finite(const std::vector<Motion>& motions) {
  return std::all_of(motions.begin(), motions.end(), [](const Motion& m) {
    return m.pose.p_WB.allFinite() && m.pose.q_WB.coeffs().allFinite() && m.twist.v_WB.allFinite() &&
           m.twist.w_WB.allFinite();
  });
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

Failure tooSlow(std::uint64_t steps, std::uint64_t of, double max_seconds) {
  return {"too slow",
          std::to_string(steps) + " of " + std::to_string(of) + " steps took " + number(max_seconds) + " s"};
}

/// The run that is looked at. Leaves the error or the failure.
void measureError(const Problem& problem, const peers::EngineSetting& engine, const peers::Task& task,
                  double max_seconds, Measurement& result) {
  const double begin = cpuNow();
  const auto run = engine.make(task);
  for (std::uint64_t k = 1; k <= result.steps; ++k) {
    run->step();
    if (problem.whole_run || k == result.steps) {
      const double time = static_cast<double>(k) * task.scene.step;
      const std::vector<Motion> motions = run->read();
      const double error = finite(motions) ? problem.error(time, motions) : NAN;
      if (!std::isfinite(error)) {
        result.failure = Failure{"not finite", "after " + number(time) + " s"};
        return;
      }
      result.error = std::max(result.error, error);
    }
    if (cpuNow() - begin > max_seconds) {
      result.failure = tooSlow(k, result.steps, max_seconds);
      return;
    }
  }
}

/// CPU seconds of all steps of a run that nobody looks at. Empty, with the reason in `result`, where they take
/// longer than `max_seconds`; the clock is looked at seldom, since a step may take less than a look.
std::optional<double> timeOf(const peers::EngineSetting& engine, const peers::Task& task, double max_seconds,
                             Measurement& result) {
  constexpr std::uint64_t kBetweenLooks = 64;
  const auto run = engine.make(task);
  const double begin = cpuNow();
  for (std::uint64_t k = 0; k < result.steps; ++k) {
    run->step();
    if (k % kBetweenLooks != 0 || cpuNow() - begin <= max_seconds) continue;
    result.failure = tooSlow(k + 1, result.steps, max_seconds);
    return std::nullopt;
  }
  return cpuNow() - begin;
}

}  // namespace

Measurement measure(const Problem& problem, const peers::EngineSetting& engine, const Request& request) {
  Measurement result;
  result.steps = static_cast<std::uint64_t>(std::max(1.0, std::round(problem.duration / request.step)));
  peers::Task task = problem.task;
  task.scene.step = request.step;
  try {
    if (request.error) measureError(problem, engine, task, request.max_seconds, result);
    if (result.failure || !request.time) return result;

    // A run of a few microseconds says little: such are repeated until 20 ms are together.
    constexpr double kEnough = 0.02;
    constexpr std::uint64_t kMost = 50;
    double fastest = INFINITY, slowest = 0.0, together = 0.0;
    const auto asked = static_cast<std::uint64_t>(request.repetitions);
    while (result.repetitions < asked || (together < kEnough && result.repetitions < kMost)) {
      const std::optional<double> seconds = timeOf(engine, task, request.max_seconds, result);
      if (!seconds) return result;
      if (*seconds > 0.0) fastest = std::min(fastest, *seconds);  // the clock may stand for a microsecond
      slowest = std::max(slowest, *seconds), together += *seconds;
      ++result.repetitions;
    }
    result.cpu_seconds = std::min(fastest, slowest), result.cpu_spread = slowest - result.cpu_seconds;
  } catch (const peers::Unsupported& e) {
    result.failure = Failure{"not supported", e.what()};
  } catch (const std::exception& e) {
    result.failure = Failure{"refused", e.what()};
  }
  return result;
}

}  // namespace rbs::accuracy

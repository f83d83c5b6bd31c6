// SPDX-License-Identifier: BSD-3-Clause
#include "pace.h"

#include "words.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rbs {
namespace {

// A step that takes less than this fraction of the available time is not the bottleneck.
constexpr double kQuickStep = 0.8;

constexpr double kLongStep = 0.5;  // s; a person who sees nothing move for that long asks why

// "0.0213", "21.3", "2130": without a power of ten, in which nobody reads a time.
std::string threeDigits(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, value < 999.5 ? "%.3g" : "%.0f", value);
  return digits;
}

// A stage is timed with its parts. This is its time without them.
double ownSeconds(const StageInfo& stage, const std::vector<StageInfo>& stages) {
  double seconds = stage.seconds;
  for (const StageInfo& part : stages)
    if (part.part_of == stage.name) seconds -= part.seconds;
  return seconds;
}

}  // namespace

bool fallsBehind(const Pace& pace) {
  return !pace.paused && pace.achieved_speed < 0.9 * pace.requested_speed;
}

std::string inWords(const Pace& pace) {
  if (pace.steps_left > 0)
    return words("stepping, ", pace.steps_left, pace.steps_left == 1 ? " step" : " steps", " to go");
  if (pace.paused) return "paused";
  const std::string achieved = threeDigits(pace.achieved_speed);
  if (pace.requested_speed == 0.0) return "real-time factor " + achieved + ", as fast as possible";
  return "real-time factor " + achieved + " of " + threeDigits(pace.requested_speed);
}

std::string bottleneck(const Pace& pace, const Snapshot& snapshot) {
  const double step = snapshot.report.seconds;
  // What is under way may take far longer than the last step, or be the first.
  if (pace.late > std::max(kLongStep, 2.0 * step))
    return words("no step has ended for ", threeDigits(pace.late), " s");
  if (!fallsBehind(pace)) return "";
  const double may_take = snapshot.step / pace.requested_speed;
  const double beside = snapshot.estimate ? 1e-3 * snapshot.estimate->beside_ms : 0.0;
  if (beside > step)
    return words("estimating errors adds ", threeDigits(1e3 * beside), " ms to a step of ",
                 threeDigits(1e3 * step), " ms");
  if (step + beside < kQuickStep * may_take)
    return words("a step takes ", threeDigits(1e3 * step), " ms of the ", threeDigits(1e3 * may_take),
                 " ms available: the processor is busy with other work");
  double most = 0.0;
  std::string slowest;
  for (const StageInfo& stage : snapshot.pipeline) {
    const double seconds = ownSeconds(stage, snapshot.pipeline);
    if (seconds > most) most = seconds, slowest = stage.name;
  }
  return words(slowest, " takes ", std::lround(100.0 * most / step), " % of a step of ",
               threeDigits(1e3 * step), " ms");
}

}  // namespace rbs

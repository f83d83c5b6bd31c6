// SPDX-License-Identifier: BSD-3-Clause
// What accuracy costs for a scene as it stands: the error of each setting of the dial, and its time.
#pragma once

#include "rigid_body_sim/difference.h"
#include "rigid_body_sim/world.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// What a setting costs, and what it gives.
struct SettingCost {
  Setting setting;
  double step_ms = 0.0;    ///< CPU time of a step of the scene with all its divisions, the mean, ms
  ErrorRate error, worst;  ///< mean over the windowed time, and largest of the windows
  bool at_most =
      false;  ///< both are upper bounds: the reference is not known well enough to measure the error
  std::uint64_t steps = 0;  ///< steps that were timed
};

struct AccuracyStudy {
  std::string scene;
  double time = 0.0;            ///< physics time that the study starts from, s
  double step = 0.0;            ///< of the scene, s
  double window = 0.0;          ///< length asked for, in whole steps, s
  double shortest = 0.0;        ///< length of the shortest window measured, s; 0: none was
  double seconds = 0.0;         ///< of physics time over which the windows begin
  std::uint32_t windows = 0;    ///< measured in which the reference converged
  std::uint32_t shortened = 0;  ///< of these, ended before `window`, where the reference still converged
  std::uint32_t dropped = 0;    ///< measured in which the reference did not converge even for one step
  ErrorRate uncertainty;  ///< of the reference: what halving its step changes, or a third of what quartering
                          ///< does, the mean
  std::string trouble;    ///< why there are no errors; empty: there are
  bool complete = false;  ///< all windows that were asked for; else time ran out or the study was stopped
  double first_answer = 0.0;          ///< CPU time after which every setting had an error, s; 0: none has
  std::vector<SettingCost> settings;  ///< in the order they were asked for
};

struct AccuracyOptions {
  double seconds = 2.0;        ///< of physics time to look ahead, 1e-6 to 1000
  double window = 0.25;        ///< s, 1e-6 to 1000; rounded to whole steps, at most 1000 of them
  std::uint32_t windows = 16;  ///< 1 to 1000, begun at equal distances along `seconds`
  double max_cpu_seconds =
      60.0;  ///< in which the study must be done, 1e-3 to 1e6; a step that has begun ends
  std::vector<Setting> settings;  ///< empty: usualSettings()
};

/// Those that a user may want to know of, from fast to exact.
std::vector<Setting> usualSettings();

/// Every fault of what is asked for; empty when it is sound.
std::vector<Problem> validate(const AccuracyOptions& options);

/// Measures settings against a reference: Fidelity::Reference in eighths of a step. All begin each window
/// with the same state, one of a run at Fidelity::Reference from the state of `world`, so that the growth of
/// errors in a chaotic scene over a long run does not count. A window ends early where the reference stops
/// converging. Where it does not converge even for one step, the window is dropped; if all are, errors are
/// given as bounds from these. The first answer takes one step of every setting, and is refined until all
/// windows are measured or the time is up. `goOn(share, study)` is called after each step with the share that
/// is done and what is known so far, and ends the study by returning false. Throws InvalidInput for faulty
/// options.
AccuracyStudy measureAccuracy(const World& world, const AccuracyOptions& options,
                              const std::function<bool(double, const AccuracyStudy&)>& goOn);

/// The cheapest setting with an error of at most this, m/s; null if there is none.
const SettingCost* cheapestWithin(const AccuracyStudy& study, double max_error);
/// The most accurate setting with a time of at most this, ms a step; null if there is none.
const SettingCost* mostAccurateWithin(const AccuracyStudy& study, double max_step_ms);

}  // namespace rbs

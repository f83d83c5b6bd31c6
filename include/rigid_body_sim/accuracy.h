// SPDX-License-Identifier: BSD-3-Clause
// Accuracy studies: the error and the CPU time of each choice of solver settings, measured on a scene.
#pragma once

#include "rigid_body_sim/difference.h"
#include "rigid_body_sim/world.h"

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// Error and CPU time of one choice of solver settings, as an AccuracyStudy measures them.
struct SettingCost {
  Setting setting;  ///< the solver settings
  /// Mean CPU time of a step of the scene with all its divisions, ms; 0: not timed yet.
  double step_ms = 0.0;
  ErrorRate error,  ///< mean error over the time of all windows
      worst;        ///< largest error of a window, or of a piece of one
  /// Whether the distances in `error` and `worst` are upper bounds: the reference is not known well enough to
  /// measure them. Angles and energies are bounds in the same way, each where its own uncertainty is large.
  bool at_most = false;
  std::uint64_t steps = 0;  ///< steps of the scene that were timed
};

/// Result of measureAccuracy(). A window is a stretch of physics time in which every choice of settings
/// and the reference run from a common state and are compared at the end.
struct AccuracyStudy {
  std::string scene;            ///< name of the scene
  double time = 0.0;            ///< physics time that the study starts from, s
  double step = 0.0;            ///< length of a step of the scene, s
  double window = 0.0;          ///< required length of a window, rounded to whole steps, s
  double shortest = 0.0;        ///< length of the shortest piece of a window measured, s; 0: none was
  double seconds = 0.0;         ///< physics time over which the windows begin, s
  std::uint32_t windows = 0;    ///< windows measured
  std::uint32_t shortened = 0;  ///< of `windows`: in pieces for convergence, or ended early for CPU time
  /// Pieces of one step in which the reference does not converge. Their uncertainties count with their errors.
  std::uint32_t inconclusive = 0;
  /// Uncertainty of the reference, the mean over the windows. In each window it is the change by halving the
  /// step of the reference, or a third of the change by quartering it, whichever is larger.
  ErrorRate uncertainty;
  std::string trouble;  ///< why there are no errors; empty: there are
  /// Whether all required windows were measured and none of them was cut short for CPU time. Else the CPU
  /// time ran out or the study was stopped.
  bool complete = false;
  double first_answer = 0.0;  ///< CPU time after which all settings had an error, s; 0: they have none
  std::vector<SettingCost> settings;  ///< in the order in which the options list them
};

/// Input of measureAccuracy().
struct AccuracyOptions {
  double seconds = 2.0;  ///< physics time to look ahead, s, 1e-6 to 1000
  double window = 0.25;  ///< length of a window, s, 1e-6 to 1000; rounded to whole steps, 1 to 1000 of them
  /// Number of windows, 1 to 1000; evenly spaced along `seconds`. There are no more than steps in it.
  std::uint32_t windows = 16;
  /// CPU time of the calling thread that the study may take, s, 1e-3 to 1e6. A step that has begun is still
  /// finished.
  double max_cpu_seconds = 60.0;
  std::vector<Setting> settings;  ///< solver settings to measure; empty: usualSettings()
};

/// The solver settings that a user may want to compare, from fast to exact.
std::vector<Setting> usualSettings();

/// Every fault of the options. Empty when they are sound.
std::vector<Problem> validate(const AccuracyOptions& options);

/// Measures solver settings against a reference, which is Fidelity::Reference with 8 divisions. `world`
/// itself does not change.
///
/// All runs of a window begin with the same state, that of a run at Fidelity::Reference from the state of
/// `world`. So the growth of errors in a chaotic scene over a long run does not count. Where the reference
/// stops converging, all runs begin again with its state, and at the latest after each step. A window ends
/// early where it would take too large a part of the CPU time.
///
/// There is no reference, and `trouble` says so, for a scene without a dynamic body, and for one with
/// restitution in which the effect impacts is off.
///
/// The first answer takes one step of every choice of settings. It is refined until all windows are measured
/// or the time is up. `goOn(share, study)` is called after each step with the fraction that is done, 0 to 1,
/// and what is known so far. It ends the study by returning false. It must not be empty. Throws InvalidInput
/// for faulty options.
AccuracyStudy measureAccuracy(const World& world, const AccuracyOptions& options,
                              const std::function<bool(double, const AccuracyStudy&)>& goOn);

/// The cheapest settings with a mean error of at most `max_error`, m/s, where an upper bound counts as the
/// error. Null where there are none. The pointer is into `study`.
const SettingCost* cheapestWithin(const AccuracyStudy& study, double max_error);
/// The most accurate settings with a time of at most `max_step_ms`, ms a step. Of errors within the
/// uncertainty of the reference the cheaper settings win. Null where there are none. The pointer is into `study`.
const SettingCost* mostAccurateWithin(const AccuracyStudy& study, double max_step_ms);

}  // namespace rbs

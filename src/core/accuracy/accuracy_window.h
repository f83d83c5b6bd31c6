// SPDX-License-Identifier: BSD-3-Clause
// One window of an accuracy study: every choice of settings and the reference run from one state, and are
// compared after 1, 2, 4, ... steps.
#pragma once

#include "rigid_body_sim/accuracy.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace rbs {

/// Largest ratio of the uncertainty of the reference to an error that counts as measured.
constexpr double kLargestUncertainty = 0.1;

/// Deviation of the runs of a window after a number of steps.
struct WindowReading {
  std::uint32_t steps = 0;
  Difference uncertainty;          ///< uncertainty of the reference; names no bodies
  std::vector<Difference> errors;  ///< of each choice of settings
  bool converged = false;  ///< the uncertainty is small beside the largest error, or beside the smallest body
};

class AccuracyWindow {
 public:
  /// `smallest`: bounding radius of the smallest dynamic body, m.
  AccuracyWindow(const World& begin, const std::vector<SettingCost>& settings, double smallest);

  /// Advances every run to this number of steps after the beginning, each step by `step`, and compares them.
  WindowReading growTo(std::uint32_t steps, const std::function<void(World&)>& step);
  /// CPU time of the runs so far, s: that of one choice of settings, and that of all with the reference.
  double secondsOf(std::size_t setting) const { return runs_[setting].seconds; }
  double seconds() const;
  /// The run that the others are compared with.
  const World& reference() const { return runs_.back().world; }

 private:
  struct Run {
    World world;
    double seconds;  ///< CPU time so far
  };

  double smallest_;
  std::uint32_t steps_ = 0;
  std::vector<Run>
      runs_;  ///< of each setting, and of the reference in a quarter, in half, and in all of its divisions
};

/// The sums of several windows, by their lengths.
class WindowSum {
 public:
  void add(const WindowReading& reading, double step);
  /// Writes the means. What the reference is not known well enough for is a bound.
  void write(AccuracyStudy& study) const;

 private:
  struct Sum {
    ErrorRate error, worst, worst_bound;  ///< of `error` the sum, of the others the largest rate
  };

  double seconds_ = 0.0;  ///< physics time of the windows together, s
  ErrorRate uncertainty_;
  std::vector<Sum> settings_;
};
}  // namespace rbs

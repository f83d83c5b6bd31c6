// SPDX-License-Identifier: BSD-3-Clause
// Governor: adaptive accuracy control. It steps a world, estimates its error and changes its solver settings.
#pragma once

#include "rigid_body_sim/world.h"

#include <memory>
#include <optional>
#include <string>

namespace rbs {

/// Adaptive accuracy control: steps a world, estimates its error on the way, and changes its solver settings
/// by its Goal. It works in windows of 0.25 s of physics time. Use one governor for one world, from one
/// thread.
class Governor {
 public:
  Governor();  ///< estimates errors only where a goal requires it
  ~Governor();
  Governor(Governor&&) noexcept;             ///< the source may only be destroyed or assigned to
  Governor& operator=(Governor&&) noexcept;  ///< the source may only be destroyed or assigned to

  /// Steps the world, and the second run beside it where errors are estimated. That run is a copy of the
  /// world, and its steps take their time on this thread. With a goal the world's solver settings may change
  /// when a window ends: for `max_error` by the estimate alone, so that equal worlds stay equal; for
  /// `max_step_ms` by the clock. An edit begins the window anew. Never throws. Returns the report
  /// of World::step().
  const StepReport& step(World& world);

  /// Sets whether errors are estimated where no goal requires it. The second run then takes twice as many
  /// divisions.
  void setEstimating(bool on);

  /// Estimate of the last window in which the settings were compared with more exact ones. Empty until such a
  /// window is over, and after a step with neither a goal nor setEstimating().
  const std::optional<ErrorEstimate>& estimate() const;
  /// Why the goal of the world has set the solver settings to what they are, or can go no further:
  /// "interactive: preview has an error of 3.2 mm/s, which is above 1 mm/s". Empty where the world has no goal, or where the
  /// goal has not required a change yet.
  std::string reason(const World& world) const;
  /// CPU time of the last step of the world, without the second run beside it, s; 0 before the first.
  double stepCpuSeconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs

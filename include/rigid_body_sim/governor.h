// SPDX-License-Identifier: BSD-3-Clause
// Governor: steps a world, tells its error as it goes, and turns the dial by the world's goal.
#pragma once

#include "rigid_body_sim/world.h"

#include <memory>
#include <optional>
#include <string>

namespace rbs {

class Governor {
 public:
  Governor();
  ~Governor();
  Governor(Governor&&) noexcept;
  Governor& operator=(Governor&&) noexcept;

  /// Steps the world, and what runs beside it. With a goal of the world it changes the world's setting when a
  /// window is over: for `max_error` by the estimate alone, so that equal worlds stay equal; for
  /// `max_step_ms` by the clock. An edit begins the window anew.
  const StepReport& step(World& world);

  /// Whether errors are estimated where no goal asks for it: beside the world runs a copy in half its steps.
  void setEstimating(bool on);

  /// Of the last window; empty until one is over.
  const std::optional<ErrorEstimate>& estimate() const;
  /// Why the goal of the world has turned the setting to what it is: "interactive: an error of 3.2 mm/s is
  /// above 1 mm/s"; empty: this goal has not turned it, or there is none.
  std::string reason(const World& world) const;
  /// CPU time of the last step of the world, without what runs beside it, s.
  double stepCpuSeconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs

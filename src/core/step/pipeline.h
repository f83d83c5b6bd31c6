// SPDX-License-Identifier: BSD-3-Clause
// The step as a table.
#pragma once

#include "rigid_body_sim/snapshot.h"
#include "state/context.h"

#include <vector>

namespace rbs {

/// The stages a scene needs, in order. Filtered again when the analysis of the scene changes.
class Pipeline {
 public:
  void filter(const SceneAnalysis& analysis);
  /// Runs one step and times every stage. It ends early where sleeping bodies have to wake for it (step.woken); all
  /// bodies are then where the step began.
  void run(Context& context);
  /// Times are sums from here on.
  void restartClocks();
  /// All stages, also those that do not run, with their reasons and their times.
  std::vector<StageInfo> describe(const SceneAnalysis& analysis, const SceneStore& scene,
                                  const StepStore& step) const;

 private:
  std::vector<std::size_t> active_;  // rows of the table
  std::vector<double> seconds_;      // by row
  std::vector<double> row_seconds_;  // by row of the inner step
};

}  // namespace rbs

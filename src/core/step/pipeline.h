// SPDX-License-Identifier: BSD-3-Clause
// The step as a table.
#pragma once

#include "rigid_body_sim/snapshot.h"
#include "state/context.h"

#include <vector>

namespace rbs {

/// The stages a scene needs, in order. Made anew when the analysis changes its mind.
class Pipeline {
 public:
  void filter(const SceneAnalysis& analysis);
  /// Runs one step and times every stage. It ends early, before anything has moved, when bodies are to be
  /// woken for it (step.woken).
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

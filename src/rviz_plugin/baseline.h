// SPDX-License-Identifier: BSD-3-Clause
// Baseline: a moment whose values count as zero, so that one sees what has changed since.
#pragma once

#include "history.h"

#include <cstddef>
#include <map>
#include <string>

namespace rbs {

class Baseline {
 public:
  /// The moment `time` of the present run, s.
  Baseline(const History& history, double time) : time_(time), run_(history.run()) {}

  /// What a curve was at the baseline. It is remembered when a run begins. A curve that had no value then counts
  /// from the first one that it has; without any, from 0.
  double valueOf(const History& history, const std::string& curve);
  /// Curves have other names from now on.
  void rename(const CurveNames& new_names) { renameKeys(values_, new_names); }
  double time() const { return time_; }  ///< s
  /// Whether it lies in the present run.
  bool isIn(const History& history) const { return run_ == history.run(); }

 private:
  double time_;
  std::size_t run_;
  std::map<std::string, double> values_;
};

}  // namespace rbs

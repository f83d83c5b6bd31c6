// SPDX-License-Identifier: BSD-3-Clause
// History: what was recorded of a simulation, curve by curve, in this run and in the one before.
#pragma once

#include "trace.h"

#include <deque>
#include <map>
#include <string>
#include <vector>

namespace rbs {

/// Something that happened, to be seen beside the curves.
struct Mark {
  double time = 0.0;  ///< s
  std::string text;   ///< sentences for people, one a line
};

using CurveNames = std::map<std::string, std::string>;  ///< new names by the last ones

/// Renames keys all at once: two may swap their names.
template <class Value>
void renameKeys(std::map<std::string, Value>& values, const CurveNames& new_names) {
  std::map<std::string, Value> renamed;
  for (const auto& [last, now] : new_names)
    if (auto value = values.extract(last)) renamed.emplace(now, std::move(value.mapped()));
  for (auto& [name, value] : renamed) values.insert_or_assign(name, std::move(value));
}

/// A run goes from the beginning of a scene to its next beginning: time only grows in it.
class History {
 public:
  void add(const std::string& curve, const Sample& sample);
  /// What happens at the time of the last mark is added to it; only the newest marks are kept.
  void mark(double time, const std::string& text);
  /// Begins a run. The present one becomes the run before, and what that was is forgotten.
  void beginRun();
  /// Forgets a curve.
  void forget(const std::string& curve);
  /// Goes on with curves under other names, in place of those that had them.
  void rename(const CurveNames& new_names);

  /// The trace of a curve in this run; an empty one for a curve that is unknown.
  const Trace& present(const std::string& curve) const;
  /// The trace of a curve in the run before; an empty one where there is none.
  const Trace& before(const std::string& curve) const;
  const std::deque<Mark>& marks() const { return marks_; }  ///< of this run, the oldest first
  double end() const { return end_; }                       ///< time of the newest sample of this run, s
  std::size_t run() const { return run_; }                  ///< how many runs have begun, besides the first

 private:
  using Traces = std::map<std::string, Trace>;

  static const Trace& find(const Traces& traces, const std::string& curve);

  Traces present_, before_;
  std::deque<Mark> marks_;
  std::size_t marked_together_ = 0;  ///< in the last mark
  double end_ = 0.0;
  std::size_t run_ = 0;
};

/// A column of a table: its heading, as "height of ball (m)", and its samples.
struct Column {
  std::string heading;
  std::vector<Sample> samples;
};

/// CSV (RFC 4180) with a heading. Its first column is the time in s; each other column has a value where it has
/// a sample at that time, and nothing elsewhere. Numbers are read back as they were, bit for bit.
std::string csvOf(const std::vector<Column>& columns);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// One measurement: the error of an engine on a problem, and what it costs.
#pragma once

#include "problem.h"

#include <cstdint>
#include <optional>

namespace rbs::accuracy {

struct Request {
  double step = 1.0 / 60;   ///< s
  bool error = true;        ///< whether the error is measured
  bool time = true;         ///< whether the CPU time is
  int repetitions = 3;      ///< of the timed run, >= 1
  double max_seconds = 60;  ///< CPU seconds that one run may take
};

/// Why there is no error, or no time.
struct Failure {
  std::string kind;  ///< "not supported", "refused", "not finite" or "too slow"
  std::string detail;
};

struct Measurement {
  std::uint64_t steps = 0;
  double error = 0.0;             ///< where it was asked for and there is no failure
  double cpu_seconds = 0.0;       ///< of the thread, all steps of the fastest run that logs nothing
  double cpu_spread = 0.0;        ///< slowest less fastest, s
  std::uint64_t repetitions = 0;  ///< that were timed; short runs are repeated more often
  std::optional<Failure> failure;
};

/// Measures what is asked for: the error in one run, the CPU time in others. Never throws for what an engine does.
Measurement measure(const Problem& problem, const peers::EngineSetting& engine, const Request& request);

}  // namespace rbs::accuracy

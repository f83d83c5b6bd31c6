// SPDX-License-Identifier: BSD-3-Clause
// What the exact solves of a step may cost. A step takes a bounded time so, and an island that is dear does
// not keep the others from being solved.
//
// Each island has an allowance of its own, by body; beyond it, islands take of what all have in common, in
// their order. So islands that need no more than their own can be solved at the same time. It is counted and
// not timed, so that equal steps end alike on all machines.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace rbs {

/// Multiplications of doubles, about. A hundred bodies have 1.5e9, which take 0.5 s (docs/stability.md).
inline constexpr std::int64_t kWorkPerBody = 8'000'000, kCommonWork = 700'000'000;

/// What solvers may still cost. Once it is spent they end with the best they have.
struct SolveBudget {
  std::int64_t work;  ///< multiplications, those included that have to be left
  /// When it is spent whatever that has cost; empty: never.
  std::optional<std::chrono::steady_clock::time_point> until = std::nullopt;
  std::int64_t to_leave = 0;  ///< of the work: it is another's
  bool isLate() const { return until && std::chrono::steady_clock::now() >= *until; }
  bool isOut() const { return work <= to_leave; }
  bool isSpent() const { return isOut() || isLate(); }
};

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// What the exact solves of a step may cost. So a step takes a bounded time, and an expensive island does not use up the
// time of the others.
//
// Each island has an allowance of its own, by body; beyond it, islands take of what all have in common, in
// their order. So islands that need no more than their own can be solved at the same time. It is counted and
// not timed, so that equal steps end alike on all machines.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace rbs {

/// Multiplications of doubles, about. Where the soft step can take over, nothing is taken of the common ones. A hundred bodies
/// have 1.5e9, which take 0.5 s (docs/stability.md).
inline constexpr std::int64_t kWorkPerBody = 8'000'000, kCommonWork = 700'000'000;

/// What solvers may still cost. Once it is spent they end with the best they have.
struct SolveBudget {
  std::int64_t left;  ///< multiplications, `reserved` included
  /// When it is spent whatever that has cost; empty: never.
  std::optional<std::chrono::steady_clock::time_point> until = std::nullopt;
  /// Of `left`: not for this solve. The bound of a single solve goes by the sum, so that it does not depend on what other
  /// islands have taken.
  std::int64_t reserved = 0;
  bool isLate() const { return until && std::chrono::steady_clock::now() >= *until; }
  bool isOut() const { return left <= reserved; }
  bool isSpent() const { return isOut() || isLate(); }
};

}  // namespace rbs

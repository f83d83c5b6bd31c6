// SPDX-License-Identifier: BSD-3-Clause
// Which bodies are near one whose course has changed within the step.
#pragma once

#include "context.h"

namespace rbs {

/// Bodies in groups of those that the broad phase has sorted next to each other, with bounds around each
/// group, so that most are passed over a group at a time.
class Neighbourhood {
 public:
  /// `order` and the bounds by body are those of the broad phase. Both must outlive it.
  Neighbourhood(const std::vector<Index>& order, std::vector<Bounds>& bounds);

  /// Gives body i, which is in the order, other bounds.
  void move(Index i, const Bounds& bounds);

  /// The other bodies whose bounds overlap those of i, in canonical order.
  std::vector<Index> of(Index i) const;

 private:
  const std::vector<Index>& order_;
  std::vector<Bounds>& bounds_;
  std::vector<Bounds> around_;  // by group
  std::vector<Index> group_;    // by body
};

}  // namespace rbs

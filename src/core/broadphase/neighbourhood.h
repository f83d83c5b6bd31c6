// SPDX-License-Identifier: BSD-3-Clause
// The bodies near a body whose trajectory has changed within the step.
#pragma once

#include "state/context.h"

namespace rbs {

/// Groups of bodies that the broad phase has sorted next to each other, with bounds around each group, so
/// that most bodies are skipped by groups.
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

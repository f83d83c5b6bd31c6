// SPDX-License-Identifier: BSD-3-Clause
// The constraint graph: bodies are its nodes, constraints its edges, and what hangs together is an island.
#pragma once

#include "rigid_body_sim/snapshot.h"
#include "state/bodies.h"

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

namespace rbs {

/// What an edge is. Each kind has a row in islands.cpp that lists its edges.
enum class ConstraintKind : std::uint8_t { Contact };

/// A constraint between up to four bodies.
struct Edge {
  ConstraintKind kind = ConstraintKind::Contact;
  Index of = kNone;  ///< its place among the constraints of its kind; of a contact: in scene.contacts.active
  std::array<Index, 4> bodies{kNone, kNone, kNone, kNone};  ///< kNone: it has fewer

  friend bool operator==(const Edge& a, const Edge& b) { return a.kind == b.kind && a.of == b.of; }
  friend bool operator<(const Edge& a, const Edge& b) {
    return std::tie(a.kind, a.of) < std::tie(b.kind, b.of);
  }
};

/// Dynamic bodies that constraints connect, and the constraints. One body without any is in flight.
struct Island {
  std::vector<Index> bodies;
  std::vector<Edge> edges;
  bool touching = false;         ///< some of its contacts touch
  double time = 0.0;             ///< how far it has been advanced
  bool exact = false;            ///< the exact step solves its constraints
  std::size_t moving_pairs = 0;  ///< its part of step.moving_pairs
  IslandResiduals residuals;
  /// What its exact solves may still cost before they take of what all may, see SolveBudget.
  std::int64_t work_left = 0;
  bool cut_short = false;                           ///< an exact solve has been ended by its budget
  std::uint32_t impacts = 0, deferred_impacts = 0;  ///< its part of the StepReport, and so are the warnings
  std::vector<Warning> warnings;

  bool flies() const { return edges.empty(); }
};

}  // namespace rbs

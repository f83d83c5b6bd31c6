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

/// What an edge is (solver/constraint_kinds.h).
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

/// A part of the graph: bodies that forces move, and constraints that tie no others of them.
struct Subgraph {
  std::vector<Index> bodies;
  std::vector<Index> contacts;  ///< in scene.contacts.active
  std::vector<Edge> edges;      ///< of the other kinds

  std::size_t constraints() const { return contacts.size() + edges.size(); }
  bool flies() const { return constraints() == 0; }
  void append(const Subgraph& other) {
    bodies.insert(bodies.end(), other.bodies.begin(), other.bodies.end());
    contacts.insert(contacts.end(), other.contacts.begin(), other.contacts.end());
    edges.insert(edges.end(), other.edges.begin(), other.edges.end());
  }
};

/// Bodies that constraints connect, with all of these. One body without any is in flight.
struct Island : Subgraph {
  bool touching = false;         ///< some of its contacts touch
  double time = 0.0;             ///< how far it has been advanced
  bool exact = false;            ///< the exact step solves its constraints
  std::size_t moving_pairs = 0;  ///< its part of step.moving_pairs
  IslandResiduals residuals;
  /// What its exact solves may still cost before they take of what all may, see SolveBudget. At a setting that has the
  /// soft step, that takes over then.
  std::int64_t work_left = 0;
  bool cut_short = false;                           ///< an exact solve has been ended by its budget
  std::uint32_t impacts = 0, deferred_impacts = 0;  ///< its part of the StepReport, and so are the warnings
  std::vector<Warning> warnings;
};

}  // namespace rbs

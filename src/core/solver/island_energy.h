// SPDX-License-Identifier: BSD-3-Clause
// The energy of islands over a soft step: what they began with, what their loads do, and which are driven.
#pragma once

#include "solver/solver_contacts.h"

#include <vector>

namespace rbs {

/// Kinetic energy of a body as the solver moves it, as seen by one that moves at U_W (m/s), J.
double kineticEnergy(const Context& context, const SolverBody& s, const Vec3& U_W);
/// Kinetic energy of the same body that only turns, at w_W (rad/s), J.
double spinEnergy(const Context& context, const SolverBody& s, const Vec3& w_W);
/// Work of its load in the `seconds` since the start of the soft step, as seen by the same, J.
double loadWork(const Context& context, const SolverBody& s, const Vec3& U_W, double seconds);

/// Some islands of a batch.
class SomeIslands {
 public:
  /// In any order; one may be listed several times.
  void set(std::vector<Index> islands);
  bool empty() const { return islands_.empty(); }
  std::size_t size() const { return islands_.size(); }
  /// The place of an island among these; kNone when it is not one of them.
  Index placeOf(Index island) const;
  /// The same of the island of a body; kNone for a body that has none.
  Index placeOf(const Context& context, const SolverBody& s) const {
    return s.inv_mass == 0.0 ? kNone : placeOf(context.step.island[s.body]);
  }

 private:
  std::vector<Index> islands_;  // ascending
};

struct IslandEnergy {
  /// Velocity of all that is in contact with the island and that forces do not move, m/s; zero where these differ, or turn. Seen
  /// by one that moves so, they do no work.
  Vec3 U_W = Vec3::Zero();
  double energy = 0.0;           ///< kinetic, at the start, as seen so, J
  double kinematic_speed = 0.0;  ///< of the fastest of them, as seen so, m/s
};

/// The islands that an energy bound is kept for.
class IslandEnergies {
 public:
  /// At the start: takes the energies of these islands, in any order; one may be listed several times.
  void begin(const Context& context, const SolverContacts& contacts, std::vector<Index> islands);
  bool empty() const { return islands_.empty(); }
  std::size_t size() const { return islands_.size(); }
  const IslandEnergy& operator[](std::size_t k) const { return energies_[k]; }
  /// The place of the island of a body; kNone when no bound is kept for it.
  Index placeOf(const Context& context, const SolverBody& s) const { return islands_.placeOf(context, s); }

 private:
  SomeIslands islands_;
  std::vector<IslandEnergy> energies_;  // by place
};

}  // namespace rbs

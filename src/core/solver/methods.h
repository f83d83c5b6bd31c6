// SPDX-License-Identifier: BSD-3-Clause
// The ways to advance islands, siblings with one signature.
#pragma once

#include "state/context.h"

#include <optional>
#include <vector>

namespace rbs {

namespace flight {
/// Bodies without contacts, in closed form.
void advance(Context& context, const Subgraph& batch, double t0, double t1);
}  // namespace flight

namespace soft_step {
/// The longest sub-step in which the constraints of a batch can follow their bodies, s; infinite where nothing moves.
double longestSubStep(const Context& context, const Subgraph& batch);
/// Whether constraints of other kinds than contacts may act in a batch. Islands with them and islands without are never advanced
/// in one batch: the pass that they need would change the others.
bool hasOtherKinds(const Context& context, const Subgraph& batch);
/// Bodies in contact, by sub-steps of soft sequential impulses.
void advance(Context& context, const Subgraph& batch, double t0, double t1);
}  // namespace soft_step

namespace exact_step {
enum class Outcome {
  Done,
  NoRoom,      ///< done, but bodies that forces do not move squeeze others, which gave way
  NoSolution,  ///< no contact forces were found; at the settings that promote islands also: no converged ones
  OverBudget,  ///< what the island may cost was spent before the end
};
/// Bodies in contact, by Coulomb's law without softness; one island at a time. NoSolution and OverBudget leave the
/// island as it was, for another method.
Outcome advance(Context& context, const Subgraph& batch, double t0, double t1);
/// The same by what the island has of its own (SolveBudget), so that islands can be advanced at the same time; nothing where
/// it needs more at an exact setting: it is left as it was. `row_seconds` gets the times of the rows.
std::optional<Outcome> advanceByItsOwn(Context& context, const Subgraph& batch, double t0, double t1,
                                       std::vector<double>& row_seconds);
}  // namespace exact_step

}  // namespace rbs

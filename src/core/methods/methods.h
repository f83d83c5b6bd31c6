// The ways to advance islands, siblings with one signature.
#pragma once

#include "context.h"

#include <vector>

namespace rbs {

/// Islands that are advanced together: all their bodies and all their pairs.
struct IslandBatch {
  std::vector<Index> bodies;  ///< movers
  std::vector<Index> pairs;   ///< in step.contacts.pairs
};

namespace flight {
/// Bodies without contacts, in closed form.
void advance(Context& context, const IslandBatch& batch, double t0, double t1);
}  // namespace flight

namespace soft_step {
/// Bodies in contact, by sub-steps of soft sequential impulses.
void advance(Context& context, const IslandBatch& batch, double t0, double t1);
/// The names of its rows, in order; step.contact_seconds has their times.
const std::vector<const char*>& stageNames();
}  // namespace soft_step

}  // namespace rbs

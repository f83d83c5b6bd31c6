// SPDX-License-Identifier: BSD-3-Clause
// The ways to advance islands, siblings with one signature.
#pragma once

#include "context.h"

#include <array>
#include <chrono>
#include <vector>

namespace rbs {

/// Islands that are advanced together: all their bodies and all their edges.
struct IslandBatch {
  std::vector<Index> bodies;
  std::vector<Edge> edges;
};

/// The rows of the methods that solve contacts; step.contact_seconds has their times.
enum ContactRow { kCollide, kSolve, kStore, kContactRows };
inline constexpr std::array<const char*, kContactRows> kContactRowNames{"narrowphase.collide",
                                                                        "contacts.solve", "contacts.store"};

/// Charges the time since its last call to a row.
class ContactClock {
 public:
  explicit ContactClock(StepStore& step) : seconds_(step.contact_seconds) {}
  void charge(ContactRow row) {
    const auto now = Clock::now();
    seconds_[row] += std::chrono::duration<double>(now - mark_).count();
    mark_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<double>& seconds_;
  Clock::time_point mark_ = Clock::now();
};

namespace flight {
/// Bodies without contacts, in closed form.
void advance(Context& context, const IslandBatch& batch, double t0, double t1);
}  // namespace flight

namespace soft_step {
/// The length of a sub-step that these edges ask for, s; at most the setting's.
double subStep(const Context& context, const std::vector<Edge>& edges);
/// Bodies in contact, by sub-steps of soft sequential impulses.
void advance(Context& context, const IslandBatch& batch, double t0, double t1);
}  // namespace soft_step

namespace exact_step {
/// Bodies in contact, by Coulomb's law without softness; one island at a time. At a setting that only
/// promotes islands to it, an island for which its solvers do not converge is left as it was, and the answer
/// is false.
bool advance(Context& context, const IslandBatch& batch, double t0, double t1);
}  // namespace exact_step

}  // namespace rbs

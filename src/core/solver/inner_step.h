// SPDX-License-Identifier: BSD-3-Clause
// THE inner step: what a method does with islands from t0 to t1, as rows in this order. Each method fills the
// rows that it has work for (soft_step.h, exact_stepper.h, flight.cpp); the times of the report come from
// running them.
//
//   row             flight       soft step                        exact step
//   collide         -            contact points                   contact points
//   prepare         -            effective masses, lanes          forces of the last step
//   beginSubStep    -            points that have drifted         how long the next segment is
//   addLoads        -            loads                            -
//   warmStart       -            the last sub-step's impulses     -
//   solve           -            one pass over the contacts       overlaps, both kicks, and the drift between them
//   integrate       closed form  positions                        goes to the end of the segment
//   relax           -            a pass without position errors   -
//   rebound         -            restitution, bounds of energy    -
//   store           -            velocities, points, impulses     points, impulses
#pragma once

#include "state/context.h"

#include <array>
#include <chrono>

namespace rbs {

/// What is timed of it. The names are those of the report.
enum InnerRow { kCollide, kPrepare, kSolve, kIntegrate, kRestitution, kStore, kInnerRows };
inline constexpr std::array<const char*, kInnerRows> kInnerRowNames{
    "narrowphase.collide", "contacts.prepare",     "contacts.solve",
    "bodies.integrate",    "contacts.restitution", "contacts.store"};

/// Charges the time since its last call to a row.
class InnerClock {
 public:
  /// @param row_seconds by row, as step.row_seconds
  explicit InnerClock(std::vector<double>& row_seconds) : seconds_(row_seconds) {}
  void charge(InnerRow row) {
    const auto now = Clock::now();
    seconds_[row] += std::chrono::duration<double>(now - mark_).count();
    mark_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<double>& seconds_;
  Clock::time_point mark_ = Clock::now();
};

/// Rows without work, for a method to hide by its own.
struct InnerRows {
  void collide() {}  ///< finds the contact points of the edges
  void prepare() {}  ///< makes the rows of the solver, and warm-starting impulses
  bool beginSubStep() {
    return false;
  }                    ///< finds points again where bodies have moved off; false: the end is reached
  void addLoads() {}   ///< velocities += loads h
  void warmStart() {}  ///< velocities += the impulses of the last sub-step
  void solve() {}      ///< the impulses of this one
  void integrate() {}  ///< positions += velocities h
  void relax() {}      ///< takes speed away that only served to separate bodies
  void rebound() {}    ///< restitution of what no located impact has rebounded
  void store() {}      ///< leaves velocities to the bodies, points and impulses to the contacts
};

template <class Method>
void runInnerStep(Method& method, InnerClock& clock) {
  method.collide();
  clock.charge(kCollide);
  method.prepare();
  clock.charge(kPrepare);
  while (method.beginSubStep()) {
    clock.charge(kCollide);
    method.addLoads();
    method.warmStart();
    method.solve();
    clock.charge(kSolve);
    method.integrate();
    clock.charge(kIntegrate);
    method.relax();
    clock.charge(kSolve);
  }
  method.rebound();
  clock.charge(kRestitution);
  method.store();
  clock.charge(kStore);
}

}  // namespace rbs

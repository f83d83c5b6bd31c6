// SPDX-License-Identifier: BSD-3-Clause
// The pace of the simulation in words: how fast it runs, and what holds it up.
#pragma once

#include "rigid_body_sim/simulator.h"

#include <string>

namespace rbs {

/// Whether the simulation runs at less than nine tenths of the requested real-time factor.
bool fallsBehind(const Pace& pace);

/// "real-time factor 0.3 of 1", "paused", "stepping, 412 steps to go", "12 x real time, as fast as possible".
std::string inWords(const Pace& pace);

/// What takes most of a step where the simulation falls behind: "contacts.solve takes 71 % of a step of 23
/// ms"; empty where it does not.
std::string bottleneck(const Pace& pace, const Snapshot& snapshot);

}  // namespace rbs

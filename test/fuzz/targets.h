// SPDX-License-Identifier: BSD-3-Clause
// What is fuzzed: functions that take any bytes. Each returns where what it calls refuses them by
// InvalidInput, and throws Broken where a promise of the core does not hold. `fuzzer.cpp` runs one of them
// under libFuzzer, `corpus_test.cpp` all of them on the inputs that are kept.
#pragma once

#include "rigid_body_sim/world.h"

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace rbs::fuzz {

/// A promise that does not hold.
struct Broken : std::logic_error {
  using std::logic_error::logic_error;
};

inline void require(bool holds, const std::string& promise) {
  if (!holds) throw Broken(promise);
}

/// A scene file: what is read is written and read again as the same text; its world steps and stays finite.
void scene(const std::uint8_t* data, std::size_t size);
/// The `state:` of a saved state of five bodies. A state that is taken and captured again is the same.
void savedState(const std::uint8_t* data, std::size_t size);
/// A mesh file; the first byte chooses its format.
void mesh(const std::uint8_t* data, std::size_t size);
/// Edits of a world, questions and steps, with hostile numbers. A refused edit leaves the state hash as it
/// was.
void world(const std::uint8_t* data, std::size_t size);

/// Throws Broken unless every pose, velocity and sum is finite.
void requireFinite(const World& world);

}  // namespace rbs::fuzz

// SPDX-License-Identifier: BSD-3-Clause
// The entry point of libFuzzer, for the target that the build names. What the target throws ends the program:
// a crash.
#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rbs::fuzz::RBS_FUZZ_TARGET(data, size);
  return 0;
}

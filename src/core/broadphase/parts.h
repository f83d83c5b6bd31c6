// SPDX-License-Identifier: BSD-3-Clause
// A search for pairs, shared by threads.
#pragma once

#include "base/index.h"
#include "base/workers.h"

#include <cstdint>
#include <vector>

namespace rbs {

/// Calls find(k, found) for k from 0 to before n, in parts of `length`. It appends pairs and returns how many tests
/// that took. Appends all pairs in the order of k, and returns the sum of the tests.
template <class Find>
std::uint64_t findInParts(Workers& workers, std::size_t n, std::size_t length, IndexPairs& found,
                          const Find& find) {
  struct Part {
    IndexPairs found;
    std::uint64_t tests = 0;
  };
  std::vector<Part> parts(Workers::parts(n, length));
  workers.share(n, length, [&](auto part, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) parts[part].tests += find(k, parts[part].found);
  });
  std::uint64_t tests = 0;
  for (const Part& part : parts) {
    found.insert(found.end(), part.found.begin(), part.found.end());
    tests += part.tests;
  }
  return tests;
}

}  // namespace rbs

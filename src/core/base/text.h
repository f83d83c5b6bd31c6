// SPDX-License-Identifier: BSD-3-Clause
// Numbers and counts in words, for reasons and messages.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace rbs {

/// A number with up to six significant digits: "9.81"; "inf", "-inf" or "nan".
inline std::string text(double value) {
  if (std::isnan(value)) return "nan";  // printf would give it the sign of a bit that means nothing
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

/// "1 body", "3 bodies".
inline std::string count(std::uint64_t n, const char* one, const char* many) {
  return std::to_string(n) + ' ' + (n == 1 ? one : many);
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// What users wrote, as messages show it again: one line, valid UTF-8, never long.
#pragma once

#include <cstddef>
#include <string>

namespace rbs {

/// How much of what a user wrote is shown again, bytes.
inline constexpr std::size_t kLongestQuote = 64, kLongestPath = 256;

/// What a user wrote, in one line of valid UTF-8 that is never long: control characters and bytes that are no
/// UTF-8 become `\\xNN`, and where it is longer than `longest` bytes its end becomes "... (N bytes)".
std::string printable(const std::string& text, std::size_t longest = kLongestQuote);

/// The same between single quotes.
std::string quoted(const std::string& text, std::size_t longest = kLongestQuote);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// What users wrote, as messages show it again: one line, valid UTF-8, never long.
#pragma once

#include <cstddef>
#include <string>

namespace rbs {

inline constexpr std::size_t kLongestQuote = 64,  ///< how much of what a user wrote messages show, bytes
    kLongestPath = 256;                           ///< how much of a file's path messages show, bytes

/// What a user wrote, as one line of valid UTF-8. Control characters and bytes that are no UTF-8 become
/// `\\xNN`. What is longer than `longest` bytes is cut there and ends in "... (N bytes)", N being the length
/// of `text`.
std::string printable(const std::string& text, std::size_t longest = kLongestQuote);

/// printable() between single quotes.
std::string quoted(const std::string& text, std::size_t longest = kLongestQuote);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Quotes of user input in messages: one line, valid UTF-8, of bounded length.
#pragma once

#include <cstddef>
#include <string>

namespace rbs {

inline constexpr std::size_t kLongestQuote = 64,  ///< longest quote of user input in a message, bytes
    kLongestPath = 256;                           ///< longest quote of a file's path in a message, bytes

/// User input as one line of valid UTF-8. Control characters and bytes that are no UTF-8 become
/// `\\xNN`. What is longer than `longest` bytes is cut there and ends in "... (N bytes)", N being the length
/// of `text`.
std::string printable(const std::string& text, std::size_t longest = kLongestQuote);

/// printable() between single quotes.
std::string quoted(const std::string& text, std::size_t longest = kLongestQuote);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/quote.h"

#include <algorithm>
#include <cstdio>

namespace rbs {
namespace {

/// The length of the character of UTF-8 that begins at `at`; 0 where there is none (RFC 3629, table of
/// section 4).
std::size_t characterAt(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) {
    return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u;
  };
  const auto follows = [&](std::size_t k) { return (byte(k) & 0xc0u) == 0x80u; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf && follows(1)) return 2;
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool beyond =
      (first == 0xed && second > 0x9f) || (first == 0xf4 && second > 0x8f);  // surrogates; the end
  if (overlong || beyond) return 0;
  if (first >= 0xe0 && first <= 0xef && follows(1) && follows(2)) return 3;
  if (first >= 0xf0 && first <= 0xf4 && follows(1) && follows(2) && follows(3)) return 4;
  return 0;
}

}  // namespace

std::string printable(const std::string& text, std::size_t longest) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    std::string next;
    const std::size_t length = characterAt(text, at);
    const auto byte = static_cast<unsigned char>(text[at]);
    if (length == 0 || byte < 0x20 || byte == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", byte);
      next = escape;
    } else {
      next = text.substr(at, length);
    }
    if (result.size() + next.size() > longest)
      return result + "... (" + std::to_string(text.size()) + " bytes)";
    result += next;
    at += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::string quoted(const std::string& text, std::size_t longest) {
  return "'" + printable(text, longest) + "'";
}

}  // namespace rbs

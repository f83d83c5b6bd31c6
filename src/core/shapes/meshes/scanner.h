// SPDX-License-Identifier: BSD-3-Clause
// Words and numbers of a text, one after the other.
#pragma once

#include "shapes/meshes/formats.h"

#include <algorithm>
#include <charconv>

namespace rbs::meshes {

class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  bool atEnd() {
    skip(" \t\r\n\f\v");
    return rest_.empty();
  }
  /// The rest of this line, without its end; the scanner goes on behind it.
  std::string_view line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }
  /// The next word, across lines; empty at the end.
  std::string_view word() {
    skip(" \t\r\n\f\v");
    const std::string_view word = rest_.substr(0, std::min(rest_.find_first_of(" \t\r\n\f\v"), rest_.size()));
    rest_.remove_prefix(word.size());
    return word;
  }
  double number() { return numberOf(word()); }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  std::string_view rest() const { return rest_; }

  /// The number that the whole word spells. Throws BadMesh.
  template <class Number = double>
  static Number numberOf(std::string_view word) {
    std::string_view digits = word;
    if (!digits.empty() && digits[0] == '+') digits.remove_prefix(1);
    Number number{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      throw BadMesh(word.empty() ? "it ends where a number is due" : "a word where a number is due",
                    "a complete file");
    }
    return number;
  }

 private:
  void skip(std::string_view blanks) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  }

  std::string_view rest_;
};

}  // namespace rbs::meshes

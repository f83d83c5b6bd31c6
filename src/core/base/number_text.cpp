// SPDX-License-Identifier: BSD-3-Clause
#include "base/number_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <numeric>
#include <sstream>

namespace rbs {
namespace {

template <class Real>
std::string shortestText(Real number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  std::string text;
  for (int digits = std::numeric_limits<Real>::digits10; digits <= 17; ++digits) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << number;
    text = stream.str();
    const std::optional<double> back = parseNumber(text);
    if (back && static_cast<Real>(*back) == number) break;
  }
  return text;
}

/// Levenshtein's edit distance: the fewest insertions, deletions and replacements of one character
/// that turn `a` into `b`. Row i of the table holds the distances of the first i characters of `a`.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string numberText(double number) {
  return shortestText(number);
}
std::string numberText(float number) {
  return shortestText(number);
}

std::string vectorText(const Vec3& v) {
  return "[" + numberText(v.x()) + ", " + numberText(v.y()) + ", " + numberText(v.z()) + "]";
}

std::optional<double> parseNumber(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double number = 0.0;
  if (!(stream >> std::noskipws >> number) || stream.peek() != std::istringstream::traits_type::eof()) {
    return std::nullopt;
  }
  return std::isfinite(number) ? std::optional<double>(number) : std::nullopt;
}

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest_name = 64;
  std::string nearest;
  if (name.size() > longest_name) return nearest;
  std::size_t least = 1 + std::max<std::size_t>(1, name.size() / 3);
  for (const std::string& candidate : candidates) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
// Numbers, bodies and the air in words, for answers, events and the log.
#pragma once

#include "rigid_body_sim/snapshot.h"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace rbs {

template <class Value>
void put(std::ostream& stream, const Value& value) {
  stream << value;
}
/// Without the sign of nan, which is chance.
inline void put(std::ostream& stream, double value) {
  std::isnan(value) ? stream << "nan" : stream << value;
}

/// Any values one after the other, numbers with up to six significant digits: "mass 1.5 kg".
template <class... Values>
std::string words(const Values&... values) {
  std::ostringstream stream;
  (put(stream, values), ...);
  return stream.str();
}

std::string inWords(const Vec3& v);                 ///< "(1, 0, 2.5)"
std::string hexadecimal(std::uint64_t number);      ///< 16 digits
std::string bodyCount(std::size_t n);               ///< "1 body", "3 bodies"
std::string describe(const BodyDescription& body);  ///< kind, shape, size, mass and material
std::string describe(const AirState& air);          ///< density, wind and gust
/// The stages that an edit has switched, or given another reason.
std::vector<std::string> stageChanges(const std::vector<StageInfo>& before,
                                      const std::vector<StageInfo>& after);

}  // namespace rbs

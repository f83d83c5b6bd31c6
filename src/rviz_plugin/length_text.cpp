// SPDX-License-Identifier: BSD-3-Clause
#include "length_text.h"

#include <iomanip>
#include <sstream>

namespace rbs {

std::string lengthText(double metres) {
  if (metres == 0.0) return "0";
  struct Unit {
    double metres;
    const char* name;
  };
  constexpr double kRounding = 0.9995;  // from which on the next unit is written
  constexpr double kSmallest = 1e-12;   // m; below it there is no unit that people know: "1.3e-15 m"
  constexpr Unit kUnits[] = {{1e3, " km"}, {1.0, " m"}, {1e-3, " mm"}, {1e-6, " µm"}, {1e-9, " nm"}};
  Unit unit = metres < kRounding * kSmallest ? kUnits[1] : kUnits[4];
  for (const Unit& larger : kUnits) {
    if (metres < kRounding * larger.metres) continue;
    unit = larger;
    break;
  }
  std::ostringstream text;
  text << std::setprecision(3) << metres / unit.metres << unit.name;
  return text.str();
}

}  // namespace rbs

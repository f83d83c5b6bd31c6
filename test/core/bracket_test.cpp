// SPDX-License-Identifier: BSD-3-Clause
// False position: functions of all bends, whose roots are known, in few values.
#include "base/bracket.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace rbs {
namespace {

struct Case {
  const char* name;
  std::function<double(double)> f;  // on (0, 2)
  double root;
  int values;  // at most, to 1e-12
};

const std::vector<Case> kCases{
    {"straight", [](double x) { return 3.0 * (x - 0.7); }, 0.7, 1},
    {"bends up", [](double x) { return x * x - 0.5; }, std::sqrt(0.5), 9},
    {"bends down", [](double x) { return std::sqrt(x) - 0.5; }, 0.25, 9},
    {"steep at one end", [](double x) { return std::exp(6.0 * x) - 2.0; }, std::log(2.0) / 6.0, 20},
    {"flat at the root", [](double x) { return std::pow(x - 1.2, 3); }, 1.2, 80},
};

TEST(Bracket, FindsTheRootInFewValuesFromBothSides) {
  for (const Case& c : kCases)
    for (const double sign : {1.0, -1.0})
      for (const bool mirrored : {false, true}) {
        const auto f = [&](double x) { return sign * c.f(mirrored ? 2.0 - x : x); };
        const double root = mirrored ? 2.0 - c.root : c.root;
        Bracket bracket(0.0, f(0.0), 2.0, f(2.0));
        double at = 0.0;
        int values = 0;
        for (; std::abs(at - root) > 1e-12 && values < 100; ++values) {
          at = bracket.guess();
          ASSERT_GE(at, bracket.low()) << c.name;
          ASSERT_LE(at, bracket.high()) << c.name;
          bracket.narrow(at, f(at));
          EXPECT_LE(bracket.low(), root + 1e-15) << c.name;
          EXPECT_GE(bracket.high(), root - 1e-15) << c.name;
        }
        EXPECT_LE(values, c.values) << c.name << ", sign " << sign << ", mirrored " << mirrored;
      }
}

}  // namespace
}  // namespace rbs

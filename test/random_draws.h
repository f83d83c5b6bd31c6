// SPDX-License-Identifier: BSD-3-Clause
// Numbers and vectors drawn at random, the same for the same seed.
#pragma once

#include "rigid_body_sim/types.h"

#include <random>

namespace rbs::test {

class RandomDraws {
 public:
  explicit RandomDraws(unsigned seed) : generator_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  /// Each coordinate between -most and most.
  Vec3 vector(double most) {
    const double x = between(-most, most), y = between(-most, most);
    return Vec3(x, y, between(-most, most));
  }

 private:
  std::mt19937 generator_;
};

}  // namespace rbs::test

// SPDX-License-Identifier: BSD-3-Clause
// The wind: what drag measures velocities against.
#include "base/algebra.h"
#include "base/random.h"
#include "effects/effects.h"

#include <cmath>

namespace rbs {

// Eight waves for each horizontal component, with periods from 0.7 s to 9 s and phases from the seed: a
// closed form in time, so that a gust is the same whatever the step. Each wave of amplitude A has variance
// A²/2; A = gust sqrt(2/8) gives the standard deviation asked for.
Vec3 airVelocity(const SceneDef& settings, double time) {
  if (!settings.wind) return Vec3::Zero();
  const Wind& wind = *settings.wind;
  Vec3 u = wind.velocity;
  if (wind.gust == 0.0) return u;
  SplitMix64 random(settings.seed);
  constexpr int kWaves = 8;
  for (int axis = 0; axis < 2; ++axis) {
    for (int k = 0; k < kWaves; ++k) {
      const double period = 0.7 * std::pow(9.0 / 0.7, (k + random.uniform()) / kWaves);
      const double phase = 2.0 * kPi * random.uniform();
      u[axis] += wind.gust * std::sqrt(2.0 / kWaves) * std::sin(2.0 * kPi * time / period + phase);
    }
  }
  return u;
}

}  // namespace rbs

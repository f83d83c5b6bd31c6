// SPDX-License-Identifier: BSD-3-Clause
// Five balls of different mass on a line, no gravity, e = 1. The first runs into the others.
//
// Between impacts all move straight on. The next impact is of the neighbours whose gap closes first; it
// exchanges the momentum 2 m1 m2 (u1 - u2)/(m1 + m2), which keeps energy and momentum.
#include "../problem.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs::accuracy {
namespace {

constexpr double kRadius = 0.1, kGap = 0.13, kSpeed = 2.0;
constexpr std::array<double, 5> kMasses{1.0, 2.0, 0.5, 1.0, 3.0};

std::array<double, 5> exactPlaces(double time) {
  std::array<double, 5> x, v{kSpeed, 0, 0, 0, 0};
  for (int k = 0; k < 5; ++k) x[k] = k * (2 * kRadius + kGap);
  for (;;) {
    double soonest = time;
    int hit = -1;
    for (int k = 0; k < 4; ++k) {
      if (v[k] <= v[k + 1]) continue;
      const double t = (x[k + 1] - x[k] - 2 * kRadius) / (v[k] - v[k + 1]);
      if (t < soonest) soonest = std::max(t, 0.0), hit = k;
    }
    for (int k = 0; k < 5; ++k) x[k] += v[k] * soonest;
    if (hit < 0) return x;
    time -= soonest;
    const double m1 = kMasses[hit], m2 = kMasses[hit + 1],
                 p = 2 * m1 * m2 / (m1 + m2) * (v[hit] - v[hit + 1]);
    v[hit] -= p / m1, v[hit + 1] += p / m2;
  }
}

Problem elasticChain() {
  Problem p;
  p.name = "elastic_chain";
  p.sentence = "A ball runs into four of other masses on a line, elastic; where are they after 3 s?";
  p.against = "exact";
  p.measure =
      "largest position error of a ball as a fraction of the distance that the first would travel alone";
  p.duration = 3.0;
  std::vector<BodyDef> balls;
  for (int k = 0; k < 5; ++k)
    balls.push_back(body(Sphere{kRadius}, kMasses[k], Vec3(k * (2 * kRadius + kGap), 0, 0),
                         Vec3(k == 0 ? kSpeed : 0, 0, 0), 0, 1));
  p.task.scene = scene(balls, Vec3::Zero());
  p.error = [](double t, const std::vector<Motion>& m) {
    const std::array<double, 5> exact = exactPlaces(t);
    double worst = 0;
    for (int k = 0; k < 5; ++k) worst = std::max(worst, (m[k].pose.p_WB - Vec3(exact[k], 0, 0)).norm());
    return worst / (kSpeed * t);
  };
  return p;
}

const RegisterProblem registered(elasticChain());

}  // namespace
}  // namespace rbs::accuracy

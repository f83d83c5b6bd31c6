// SPDX-License-Identifier: BSD-3-Clause
// Two balls without spin meet a floor at a slant, no gravity; e = 0.5, mu = 0.3. The normal speed u turns
// into e u, so the normal impulse is m (1 + e) u. Friction would need m (2/7) v to end the slip v of the
// lowest point; it gives that if it is below mu m (1 + e) u, and the ball then rolls: that is the steep one.
// Else it gives all that it can, and the ball goes on slipping: the flat one. An impulse P at the bottom
// turns the ball at 5 P/(2 m R).
#include "../problem.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs::accuracy {
namespace {

constexpr double kE = 0.5, kMu = 0.3, kR = 0.1, kMeets = 0.4137;

struct Thrown {
  double y, along, down;  // where it flies, and its speeds
};
constexpr std::array<Thrown, 2> kBalls{{{0.0, 1.0, 2.0}, {2.0, 4.0, 1.0}}};

Problem obliqueImpact() {
  std::vector<BodyDef> bodies{floor(kMu, kE)};
  for (const Thrown& b : kBalls)
    bodies.push_back(
        body(Sphere{kR}, 1.0, Vec3(0, b.y, kR + b.down * kMeets), Vec3(b.along, 0, -b.down), kMu, kE));
  Problem p;
  p.name = "oblique_impact";
  p.sentence =
      "Two balls hit a floor at a slant, one leaves it rolling, one still slipping; where are they after 1 "
      "s?";
  p.against = "exact";
  p.measure =
      "largest of: position error as a fraction of the distance; R times the error of the angular velocity "
      "as a "
      "fraction of the speed";
  p.duration = 1.0;
  p.task.scene = scene(bodies, Vec3::Zero());
  p.error = [](double t, const std::vector<Motion>& m) {
    double worst = 0;
    for (std::size_t k = 0; k < kBalls.size(); ++k) {
      const Thrown& b = kBalls[k];
      const double speed = std::hypot(b.along, b.down), after = t - kMeets;
      const double friction = after > 0 ? std::min(kMu * (1 + kE) * b.down, 2.0 / 7 * b.along) : 0.0;
      const double height = after > 0 ? kE * b.down * after : -b.down * after;
      const Vec3 place(b.along * t - friction * std::max(after, 0.0), b.y, kR + height);
      const Vec3 spin(0, 2.5 * friction / kR, 0);
      worst = std::max({worst, (m[1 + k].pose.p_WB - place).norm() / (speed * t),
                        kR * (m[1 + k].twist.w_WB - spin).norm() / speed});
    }
    return worst;
  };
  return p;
}

const RegisterProblem registered(obliqueImpact());

}  // namespace
}  // namespace rbs::accuracy

// SPDX-License-Identifier: BSD-3-Clause
// A ball that falls through air: m v' = m g - k v² with k = rho c A/2. With V = √(m g/k) it falls at V tanh(g
// t/V), and has fallen (V²/g) ln cosh(g t/V).
#include "../problem.h"

#include <cmath>

namespace rbs::accuracy {
namespace {

Problem terminalVelocity() {
  const double R = 0.05, mass = 0.05, rho = 1.2, height = 100.0;
  const double k = 0.5 * rho * kRoundedDrag * M_PI * R * R, V = std::sqrt(mass * kGravity / k);
  Problem p;
  p.name = "terminal_velocity";
  p.sentence = "A light ball falls through air for 5 s, towards its terminal velocity; how far?";
  p.against = "exact";
  p.measure = "position error as a fraction of the distance";
  p.duration = 5.0;
  p.task.scene = scene({body(Sphere{R}, mass, Vec3(0, 0, height))});
  p.task.scene.air = Air{rho};
  p.error = [=](double t, const std::vector<Motion>& m) {
    const double fallen = V * V / kGravity * std::log(std::cosh(kGravity * t / V));
    return (m[0].pose.p_WB - Vec3(0, 0, height - fallen)).norm() / fallen;
  };
  return p;
}

const RegisterProblem registered(terminalVelocity());

}  // namespace
}  // namespace rbs::accuracy

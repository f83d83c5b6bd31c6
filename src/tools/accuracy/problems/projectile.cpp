// SPDX-License-Identifier: BSD-3-Clause
// A ball thrown in a vacuum: x = x0 + v0 t + g t²/2.
#include "../problem.h"

namespace rbs::accuracy {
namespace {

Problem projectile() {
  const Vec3 start(0, 0, 10), thrown(3, -2, 8), g(0, 0, -kGravity);
  Problem p;
  p.name = "projectile";
  p.sentence = "A ball is thrown and flies for 2 s; where is it?";
  p.against = "exact";
  p.measure = "position error as a fraction of g t²/2";
  p.duration = 2.0;
  p.task.scene = scene({body(Sphere{0.1}, 1.0, start, thrown)});
  p.error = [=](double t, const std::vector<Motion>& m) {
    const Vec3 exact = start + thrown * t + 0.5 * t * t * g;
    return (m[0].pose.p_WB - exact).norm() / (0.5 * t * t * kGravity);
  };
  return p;
}

const RegisterProblem registered(projectile());

}  // namespace
}  // namespace rbs::accuracy

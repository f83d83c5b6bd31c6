// SPDX-License-Identifier: BSD-3-Clause
// A ball dropped from a height h over a floor: it meets the floor after t0 = √(2h/g) with the speed u = g t0,
// leaves it with e u, is back after 2 e t0, and so on. In flight k it leaves with e^k u.
#include "../problem.h"

#include <cmath>

namespace rbs::accuracy {
namespace {

double exactHeight(double drop, double e, double time) {
  const double first = std::sqrt(2 * drop / kGravity);
  if (time <= first) return drop - 0.5 * kGravity * time * time;
  double since = time - first, speed = e * kGravity * first;
  while (since > 2 * speed / kGravity) since -= 2 * speed / kGravity, speed *= e;
  return speed * since - 0.5 * kGravity * since * since;
}

Problem bouncing(const std::string& name, const std::string& sentence, double e, double duration) {
  const double radius = 0.5, drop = 1.0;
  Problem p;
  p.name = name;
  p.sentence = sentence;
  p.against = "exact";
  p.measure = "position error as a fraction of the height of the drop";
  p.duration = duration;
  p.task.scene =
      scene({floor(0, e), body(Sphere{radius}, 1.0, Vec3(0, 0, radius + drop), Vec3::Zero(), 0, e)});
  p.error = [=](double t, const std::vector<Motion>& m) {
    return (m[1].pose.p_WB - Vec3(0, 0, radius + exactHeight(drop, e, t))).norm() / drop;
  };
  return p;
}

const RegisterProblem elastic(bouncing("bounce_elastic",
                                       "An elastic ball bounces 11 times in 10 s; where is it?", 1.0, 10.0));
const RegisterProblem damped(bouncing("bounce_damped",
                                      "A ball with e = 0.8 bounces 4 times in 2.4 s; where is it?", 0.8,
                                      2.4));

}  // namespace
}  // namespace rbs::accuracy

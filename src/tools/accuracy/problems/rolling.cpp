// SPDX-License-Identifier: BSD-3-Clause
// Balls that roll.
//
// A ball thrown along a floor without spin slides with the deceleration mu g, while its spin grows at 5 mu
// g/(2R). They agree, v = R w, at t = 2 v0/(7 mu g), when v = 5 v0/7; from then on it rolls and nothing
// changes.
//
// A plate of mass M is pulled by F over a floor with friction; 25 balls of mass m roll on it. The plate
// slides, so the floor takes f1 = mu (M + 25 m) g against its way. Each ball feels f2 at its lowest point: m
// a_b = f2 and (2/5) m R² alpha = R f2, and that point goes with the plate: a_b + R alpha = a. So f2 = 2 m
// a/7, a_b = 2 a/7, and a = (F - f1)/(M + 25 (2/7) m). By symmetry nothing turns the plate.
#include "../problem.h"

#include <algorithm>
#include <cmath>

namespace rbs::accuracy {
namespace {

Problem slidingToRolling() {
  const double mu = 0.3, v = 10.0, R = 0.5;
  const double rolls = 2 * v / (7 * mu * kGravity);
  Problem p;
  p.name = "sliding_to_rolling";
  p.sentence =
      "A ball is thrown along a floor at 10 m/s without angular velocity; where does it roll after 3 s?";
  p.against = "exact";
  p.measure =
      "the larger of: position error as a fraction of the distance; R times the error of the angular "
      "velocity "
      "as a fraction of 10 m/s";
  p.duration = 3.0;
  p.task.scene = scene({floor(mu), body(Sphere{R}, 1.0, Vec3(0, 0, R), Vec3(v, 0, 0), mu)});
  p.error = [=](double t, const std::vector<Motion>& m) {
    const double sliding = std::min(t, rolls);
    const double way = v * sliding - 0.5 * mu * kGravity * sliding * sliding + 5.0 / 7 * v * (t - sliding);
    const double spin = 2.5 * mu * kGravity / R * sliding;
    return std::max((m[1].pose.p_WB - Vec3(way, 0, R)).norm() / way,
                    R * (m[1].twist.w_WB - Vec3(0, spin, 0)).norm() / v);
  };
  return p;
}

Problem rollingOblique() {
  constexpr int kBalls = 25;
  const double M = 10.0, m = 1.0, R = 0.5, F = 150.0;
  const Vec3 direction(0.5, std::sqrt(0.75), 0), size(20, 20, 1);
  // Of a pair the geometric mean counts: 0.8 of plate and ball, 0.4 of plate and floor.
  const double on_plate = 0.8, of_floor = 0.2, mu = 0.4;
  const double a = (F - mu * (M + kBalls * m) * kGravity) / (M + kBalls * 2.0 / 7 * m);

  std::vector<BodyDef> bodies{floor(of_floor), body(Box{size}, M, Vec3(0, 0, 0.5), Vec3::Zero(), on_plate)};
  std::vector<Vec3> places;
  for (int k = 0; k < kBalls; ++k) {
    places.emplace_back(3.0 * (k % 5 - 2), 3.0 * (k / 5 - 2), 1 + R);
    bodies.push_back(body(Sphere{R}, m, places.back(), Vec3::Zero(), on_plate));
  }
  Problem p;
  p.name = "rolling_oblique";
  p.sentence =
      "A plate with 25 balls on it is pulled over a floor, 60 degrees off its edges; where are they after 2 "
      "s?";
  p.against = "exact";
  p.measure = "largest position error of a body as a fraction of the distance of the plate";
  p.duration = 2.0;
  p.steps.pop_back();  // for the sake of time
  p.task = {scene(bodies), {{1, F * direction}}};
  p.error = [=](double t, const std::vector<Motion>& motions) {
    const double way = 0.5 * a * t * t;
    double worst = (motions[1].pose.p_WB - Vec3(0, 0, 0.5) - way * direction).norm();
    for (int k = 0; k < kBalls; ++k)
      worst = std::max(worst, (motions[2 + k].pose.p_WB - places[k] - 2.0 / 7 * way * direction).norm());
    return worst / way;
  };
  return p;
}

const RegisterProblem thrown(slidingToRolling()), pulled(rollingOblique());

}  // namespace
}  // namespace rbs::accuracy

// SPDX-License-Identifier: BSD-3-Clause
// A flat box that slides on a floor. Coulomb's friction is mu g against the slip, wherever its weight rests:
// it does not turn, as the friction of all of it passes through the line along which its centre moves.
//
// The slopes are the same floor with gravity tilted against it.
#include "../problem.h"

#include <cmath>

namespace rbs::accuracy {
namespace {

const Vec3 kSize(1.0, 1.0, 0.2);

Vec3 tilted(double degrees) {
  const double angle = degrees * M_PI / 180;
  return kGravity * Vec3(std::sin(angle), 0, -std::cos(angle));
}

peers::Task boxOnFloor(double mu, const Vec3& velocity, const Vec3& gravity) {
  return {scene({floor(mu), body(Box{kSize}, 10.0, Vec3(0, 0, 0.5 * kSize.z()), velocity, mu)}, gravity), {}};
}

double distanceFrom(const Vec3& place, const Motion& motion) {
  return (motion.pose.p_WB - place - Vec3(0, 0, 0.5 * kSize.z())).norm();
}

Problem slidingStop() {
  const double mu = 0.5, v = 5.0, heading = 20 * M_PI / 180;
  const Vec3 direction(std::cos(heading), std::sin(heading), 0);
  const double stop = v / (mu * kGravity), length = 0.5 * v * stop;
  Problem p;
  p.name = "sliding_stop";
  p.sentence =
      "A box slides at 5 m/s, 20 degrees off its edges, until friction stops it; where does it stop?";
  p.against = "exact";
  p.measure = "position error as a fraction of the distance";
  p.duration = 1.6;
  p.task = boxOnFloor(mu, v * direction, Vec3(0, 0, -kGravity));
  p.error = [=](double t, const std::vector<Motion>& m) {
    const double way = t < stop ? v * t - 0.5 * mu * kGravity * t * t : length;
    return distanceFrom(way * direction, m[1]) / length;
  };
  return p;
}

Problem slopeSlip() {
  const double mu = 0.5;
  const Vec3 g = tilted(35);
  const double a = g.x() + mu * g.z();
  Problem p;
  p.name = "slope_slip";
  p.sentence = "A box is let go on a slope of 35 degrees with mu = 0.5; how far does it slide in 2 s?";
  p.against = "exact";
  p.measure = "position error as a fraction of the distance";
  p.duration = 2.0;
  p.task = boxOnFloor(mu, Vec3::Zero(), g);
  p.error = [=](double t, const std::vector<Motion>& m) {
    const double way = 0.5 * a * t * t;
    return distanceFrom(Vec3(way, 0, 0), m[1]) / way;
  };
  return p;
}

Problem slopeStick() {
  Problem p;
  p.name = "slope_stick";
  p.sentence = "A box lies on a slope of 20 degrees with mu = 0.5, so that it sticks; does it stay for 5 s?";
  p.against = "exact";
  p.measure = "distance that it moved, as a fraction of its edge";
  p.duration = 5.0;
  p.task = boxOnFloor(0.5, Vec3::Zero(), tilted(20));
  p.error = [](double, const std::vector<Motion>& m) { return distanceFrom(Vec3::Zero(), m[1]) / kSize.x(); };
  return p;
}

const RegisterProblem stop(slidingStop()), slip(slopeSlip()), stick(slopeStick());

}  // namespace
}  // namespace rbs::accuracy

// SPDX-License-Identifier: BSD-3-Clause
// Elastic balls without friction or gravity between six walls. The motion is chaotic, so only what must stay
// is compared: the kinetic energy. A ball that has left the box is no gas any more: the error is then
// infinite.
#include "../problem.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace rbs::accuracy {
namespace {

constexpr double kHalf = 1.0, kRadius = 0.1, kMass = 1.0;
constexpr int kWalls = 6;

double energyOf(const std::vector<Motion>& motions) {
  double energy = 0;
  for (std::size_t k = kWalls; k < motions.size(); ++k) {
    const Twist& twist = motions[k].twist;
    energy += 0.5 * kMass * (twist.v_WB.squaredNorm() + 0.4 * kRadius * kRadius * twist.w_WB.squaredNorm());
  }
  return energy;
}

Problem gas() {
  std::vector<BodyDef> bodies;
  for (const Vec3& inwards :
       {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    BodyDef wall = floor(0, 1);
    wall.pose.p_WB = -kHalf * inwards;
    wall.pose.q_WB = Quat(Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), inwards));
    bodies.push_back(wall);
  }
  std::mt19937_64 random(1);
  const auto speed = [&random] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  double energy = 0;
  for (int k = 0; k < 27; ++k) {
    const Vec3 place = 0.5 * Vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = speed();
    energy += 0.5 * kMass * v.squaredNorm();
    bodies.push_back(body(Sphere{kRadius}, kMass, place, v, 0, 1));
  }
  Problem p;
  p.name = "gas";
  p.sentence = "27 elastic balls fly about in a box for 5 s; is their energy kept?";
  p.against = "invariant";
  p.measure = "largest change of the energy as a fraction of it";
  p.duration = 5.0;
  p.whole_run = true;
  p.steps.pop_back();  // for the sake of time
  p.task.scene = scene(bodies, Vec3::Zero());
  p.error = [energy](double, const std::vector<Motion>& m) {
    for (std::size_t k = kWalls; k < m.size(); ++k)
      if (m[k].pose.p_WB.cwiseAbs().maxCoeff() > kHalf) return double(INFINITY);
    return std::abs(energyOf(m) - energy) / energy;
  };
  return p;
}

const RegisterProblem registered(gas());

}  // namespace
}  // namespace rbs::accuracy

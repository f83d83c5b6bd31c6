// SPDX-License-Identifier: BSD-3-Clause
// Bodies that rock on a round one without slip: the contact travels over them, and neither energy nor time is lost.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rbs::test {
namespace {

constexpr double kTilt = 0.1;    // rad, at the start, at rest
constexpr double kRadius = 0.5;  // m, of the round body
constexpr double kThin = 0.05;   // m, half the thickness of the one on it

struct Rocker {
  const char* name;
  Shape base;
  Quat q_WBase;
  Shape top;
  Quat q_Top;      // level: its length along x
  double inertia;  // about y, of 1 kg, kg m²
};

const Quat kAlongX(Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitY())),
    kAlongY(Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX()));

const Rocker kRockers[] = {
    {"plank on cylinder", Cylinder{kRadius, 0.5}, kAlongY, Box{{2.0, 0.4, 2.0 * kThin}}, Quat::Identity(),
     4.01 / 12.0},
    {"plank on capsule", Capsule{kRadius, 0.5}, kAlongY, Box{{2.0, 0.4, 2.0 * kThin}}, Quat::Identity(),
     4.01 / 12.0},
    {"plank on ball", Sphere{kRadius}, kAlongY, Box{{2.0, 0.4, 2.0 * kThin}}, Quat::Identity(), 4.01 / 12.0},
    {"cylinder across cylinder", Cylinder{kRadius, 0.5}, kAlongY, Cylinder{kThin, 1.0}, kAlongX,
     4.0 / 12.0 + 0.25 * kThin* kThin},
};

struct Rocked {
  double energy;  // at the end, as a share of that at the start
  double period;  // mean, s
};

// Energy is measured from where the rocker is level.
Rocked rock(const Rocker& rocker, Fidelity fidelity, double step, double seconds) {
  SceneDef scene;
  scene.step = step;
  scene.fidelity = fidelity;
  BodyDef base = body("base", rocker.base, Vec3::Zero());
  base.kind = BodyKind::Static;
  base.pose.q_WB = rocker.q_WBase;
  const Vec3 normal(std::sin(kTilt), 0.0, std::cos(kTilt)), along(std::cos(kTilt), 0.0, -std::sin(kTilt));
  BodyDef top = body("top", rocker.top, (kRadius + kThin) * normal - kRadius * kTilt * along);
  top.pose.q_WB = Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitY())) * rocker.q_Top;
  top.mass = 1.0;
  base.material.friction = top.material.friction = 2.0;
  scene.bodies = {base, top};
  World world(ordered(scene));
  const double level = kGravity * (kRadius + kThin), first = energy(world) - level;
  const BodyId id = world.find("top");
  double crossed = 0.0, earlier = 0.0, first_crossing = 0.0;
  int crossings = 0;
  while (world.time() < seconds - 0.5 * step) {
    world.step();
    const double x = world.pose(id).p_WB.x();
    if (earlier < 0.0 && x >= 0.0) {
      crossed = world.time() - step * x / (x - earlier);
      if (crossings++ == 0) first_crossing = crossed;
    }
    earlier = x;
  }
  return {(energy(world) - level) / first, (crossed - first_crossing) / (crossings - 1)};
}

// Of small swings; those here take 0.4 % longer. With b half the thickness and t the tilt, the energy is
// m g (R - b) t²/2 + (I + m b²) t'²/2.
double periodOf(const Rocker& rocker) {
  return 2.0 * kPi * std::sqrt((rocker.inertia + kThin * kThin) / (kGravity * (kRadius - kThin)));
}

TEST(Rocking, KeepsItsEnergyAndItsPeriod) {
  struct Case {
    Fidelity fidelity;
    double step, least, most;
  };
  for (const Rocker& rocker : kRockers)
    for (const Case& c :
         {Case{Fidelity::Preview, 1.0 / 60.0, 0.8, 1.005}, Case{Fidelity::Preview, 1.0 / 240.0, 0.985, 1.002},
          Case{Fidelity::Interactive, 1.0 / 60.0, 0.95, 1.35},
          Case{Fidelity::Interactive, 1.0 / 240.0, 0.99, 1.04},
          Case{Fidelity::Accurate, 1.0 / 60.0, 0.999, 1.001}}) {
      const Rocked rocked = rock(rocker, c.fidelity, c.step, 60.0);
      SCOPED_TRACE(std::string(rocker.name) + " at " + fidelityName(c.fidelity) + ", step " +
                   std::to_string(c.step));
      EXPECT_GE(rocked.energy, c.least);
      EXPECT_LE(rocked.energy, c.most);
      EXPECT_NEAR(rocked.period / periodOf(rocker), 1.0, 0.006);
    }
}

}  // namespace
}  // namespace rbs::test

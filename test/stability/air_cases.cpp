// SPDX-License-Identifier: BSD-3-Clause
// Drag and wind.
#include "measure.h"

#include <algorithm>
#include <cstring>

namespace rbs::stability {
namespace {

using namespace test;

constexpr double kDensity = 1.2;  // kg/m³

/// k of the acceleration -k |u| u of a ball.
double dragOf(double radius, double mass) {
  return 0.5 * kDensity * kRoundedDrag * kPi * radius * radius / mass;
}

BodyDef lightBall(double radius, double mass, const Vec3& p_W) {
  BodyDef def = ball("ball", radius, p_W);
  def.mass = mass;
  return def;
}

void terminalVelocity(Sheet& sheet) {
  SceneDef scene;
  scene.step = kFrame;
  scene.air = Air{kDensity};
  scene.bodies.push_back(lightBall(0.2, 0.5, Vec3::Zero()));
  Watch watch(scene, sheet.setting());
  const double k = dragOf(0.2, 0.5), vt = std::sqrt(kGravity / k);
  double speed = 0.0, place = 0.0;
  for (int n = 0; n < 300; ++n) {
    watch.step();
    const double x = kGravity * watch.world().time() / vt;
    speed = std::max(speed, std::abs(-watch["ball"].twist.v_WB.z() - vt * std::tanh(x)) / vt);
    const double z = vt * vt / kGravity * std::log(std::cosh(x));
    place = std::max(place, std::abs(-watch["ball"].pose.p_WB.z() - z) / std::max(z, vt * kFrame));
  }
  sheet.error("speed, of the terminal one", "", speed, fastAndExact(1e-3, 1e-9));
  sheet.error("place, relative", "", place, fastAndExact(1e-3, 1e-9));
  watch.run(30.0);
  sheet.error("terminal velocity, relative", "", -watch["ball"].twist.v_WB.z() / vt - 1.0,
              fastAndExact(1e-3, 1e-9));
}

void steadyWind(Sheet& sheet) {
  SceneDef scene = emptySpace(kFrame);
  scene.air = Air{kDensity};
  scene.wind = Wind{Vec3(10.0, 0.0, 0.0), 0.0};
  scene.bodies.push_back(lightBall(0.2, 0.5, Vec3::Zero()));
  Watch watch(scene, sheet.setting());
  const double k = dragOf(0.2, 0.5);
  double worst = 0.0;
  for (int n = 0; n < 300; ++n) {
    watch.step();
    const double relative = 10.0 / (1.0 + k * 10.0 * watch.world().time());
    worst = std::max(worst, std::abs(10.0 - watch["ball"].twist.v_WB.x() - relative));
  }
  sheet.error("velocity, of the wind", "", worst / 10.0, closedForm(1e-9));

  scene.step = 0.1;
  scene.wind->velocity.x() = 100.0;
  scene.bodies[0].mass = 1e-6;
  Watch feather(scene, sheet.setting());
  double beyond = 0.0, error = 0.0;
  const double stiff = dragOf(0.2, 1e-6);
  for (int n = 0; n < 100; ++n) {
    feather.step();
    const double v = feather["ball"].twist.v_WB.x();
    beyond = std::max({beyond, v - 100.0, -v});
    error = std::max(error, std::abs(100.0 - v - 100.0 / (1.0 + stiff * 100.0 * feather.world().time())));
  }
  sheet.error("a mote of 1e-6 kg in 100 m/s at 10 Hz: beyond the wind", "m/s", std::max(0.0, beyond),
              every(1e-10));
  sheet.error("a mote of 1e-6 kg: velocity, of the wind", "", error / 100.0, closedForm(1e-9));
}

// u' = k |w - u| (w - u), w = 8 (1 + 0.2 sin 2t), set anew before each step; by Runge and Kutta in tiny
// steps.
double gustError(Fidelity setting, double step) {
  SceneDef scene = emptySpace(step);
  scene.air = Air{kDensity};
  scene.wind = Wind{Vec3(8.0, 0.0, 0.0), 0.0};
  scene.bodies.push_back(lightBall(0.2, 0.05, Vec3::Zero()));
  Watch watch(scene, setting);
  const long double k = dragOf(0.2, 0.05);
  const auto wind = [](long double t) { return 8.0L * (1.0L + 0.2L * std::sin(2.0L * t)); };
  const auto rate = [&](long double t, long double u) { return k * std::abs(wind(t) - u) * (wind(t) - u); };
  long double t = 0.0L, u = 0.0L;
  double worst = 0.0;
  for (int n = 0; n < std::lround(5.0 / step); ++n) {
    const double middle = watch.world().time() + 0.5 * step;
    watch.world().setWind(Wind{Vec3(static_cast<double>(wind(middle)), 0.0, 0.0), 0.0});
    watch.step();
    for (int part = 0; part < 200; ++part) {
      const long double h = step / 200.0L;
      const long double k1 = rate(t, u), k2 = rate(t + 0.5L * h, u + 0.5L * h * k1);
      const long double k3 = rate(t + 0.5L * h, u + 0.5L * h * k2), k4 = rate(t + h, u + h * k3);
      u += h / 6.0L * (k1 + 2.0L * k2 + 2.0L * k3 + k4), t += h;
    }
    worst = std::max(worst, std::abs(watch["ball"].twist.v_WB.x() - static_cast<double>(u)));
  }
  return worst / 8.0;
}

void gust(Sheet& sheet) {
  const double coarse = gustError(sheet.setting(), kFrame), fine = gustError(sheet.setting(), 0.5 * kFrame);
  sheet.error("velocity at 60 Hz, of the wind", "", coarse, shown());
  sheet.error("velocity at 1000 Hz, of the wind", "", gustError(sheet.setting(), 1e-3), exact(1e-6));
  const double order = std::log2(coarse / fine);
  sheet.error("order of convergence below 2", "", std::max(0.0, 2.0 - order), fastAndExact(0.1, 0.1));
}

void boxInWind(Sheet& sheet) {
  SceneDef scene = emptySpace(kFrame);
  scene.air = Air{kDensity};
  scene.wind = Wind{Vec3(10.0, 0.0, 0.0), 0.0};
  scene.bodies = {box("square", Vec3(1.0, 0.5, 0.25), Vec3::Zero()), ball("ball", 0.3, Vec3(0.0, 5.0, 0.0)),
                  box("oblique", Vec3(1.0, 0.5, 0.25), Vec3(0.0, 10.0, 0.0))};
  scene.bodies[2].pose.q_WB = Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()));
  for (BodyDef& def : scene.bodies) def.mass = 5.0;
  Watch watch(scene, sheet.setting());
  watch.step();
  sheet.error("spin of a box square to the wind", "rad/s", watch["square"].twist.w_WB.norm(), every(1e-12));
  sheet.error("spin of a ball", "rad/s", watch["ball"].twist.w_WB.norm(), every(0.0));
  sheet.error("spin of an oblique box that does not turn", "rad/s", watch["oblique"].twist.w_WB.norm(),
              every(1e-12));
  const double k = 0.5 * kDensity * kEdgedDrag * 0.5 * 0.25 / 5.0;
  sheet.error("speed of the square box after a step, relative", "",
              watch["square"].twist.v_WB.x() / (10.0 - 10.0 / (1.0 + 10.0 * k * kFrame)) - 1.0,
              closedForm(1e-9));

  scene.wind.reset();
  scene.bodies[0].twist.w_WB = {0.0, 0.0, 20.0};
  Watch spins(scene, sheet.setting());
  spins.run(5.0);
  const double left = spins["square"].twist.w_WB.z() / 20.0;
  sheet.check("still air slows a spinning box and never turns it round", 0.0 < left && left < 0.999,
              every(0.0));

  SceneDef airless = scene, never = scene;
  airless.air.reset(), never.air.reset();
  for (BodyDef& def : airless.bodies) def.material.drag_coefficient = 3.0;
  Watch one(airless, sheet.setting()), two(never, sheet.setting());
  one.run(2.0), two.run(2.0);
  bool same = true;
  for (const char* name : {"square", "ball", "oblique"}) {
    const BodyState a = one[name], b = two[name];
    same &= a.pose.p_WB == b.pose.p_WB && a.pose.q_WB.coeffs() == b.pose.q_WB.coeffs() &&
            a.twist.v_WB == b.twist.v_WB && a.twist.w_WB == b.twist.w_WB;
  }
  sheet.check("without air the drag coefficient changes no bit", same, every(0.0));
}

}  // namespace

std::vector<Case> airCases() {
  return {
      {"A70", "Terminal velocity",
       "A ball (R = 0.2 m, 0.5 kg) falls in still air for 35 s at 60 Hz. Exact: v = v_t tanh(g t/v_t), z = "
       "v_t²/g ln cosh(g "
       "t/v_t).",
       terminalVelocity},
      {"A71", "Steady wind",
       "The same ball without gravity in a wind of 10 m/s: its speed through the air is w/(1 + k w t). A "
       "mote of 1e-6 kg in "
       "100 m/s at 10 Hz never passes the wind.",
       steadyWind},
      {"A72", "Gusts",
       "A ball of 0.05 kg in a wind of 8 (1 + 0.2 sin 2t) m/s, given at the middle of each step, for 5 s. "
       "Reference: "
       "Runge-Kutta in long double at tiny steps. The order is measured from 60 to 120 Hz.",
       gust},
      {"A73", "A box in the wind",
       "Neither a box square to the wind nor one that does not turn nor a ball feels a torque; the box gains "
       "10 − 10/(1 + 10 k "
       "h) m/s in a step of 10 m/s wind. Still air slows a spin. A scene without air is bit for bit one "
       "without drag.",
       boxInWind},
  };
}

}  // namespace rbs::stability

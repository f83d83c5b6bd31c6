// SPDX-License-Identifier: BSD-3-Clause
// Fast bodies: time of impact, and that nothing passes a wall.
#include "base/random.h"
#include "measure.h"

#include <algorithm>

namespace rbs::stability {
namespace {

using namespace test;

void makeElastic(SceneDef& scene) {
  for (BodyDef& def : scene.bodies) def.material.friction = 0.0, def.material.restitution = 1.0;
}

void bulletAndPaper(Sheet& sheet) {
  // The time of impact, read off the place after an elastic rebound.
  double worst = 0.0;
  for (int shot = 0; shot < 18; ++shot) {
    const double R = 0.01, thickness = 1e-3, v = 1e3, distance = 3.0 + 0.61 * shot, turn = 0.05 * shot;
    SceneDef scene = emptySpace(kFrame);
    scene.bodies = {fixedBox("paper", Vec3(thickness, 40.0, 40.0), Vec3::Zero()),
                    ball("bullet", R, Vec3(-distance, 0.0, 0.0))};
    scene.bodies[1].twist.v_WB = v * Vec3(std::cos(turn), std::sin(turn), 0.0);
    makeElastic(scene);
    Watch watch(scene, sheet.setting());
    const double along = v * std::cos(turn), hit = (distance - R - 0.5 * thickness) / along;
    while (watch.world().time() < hit + 1e-4) watch.step();
    const double t = watch.world().time();
    const double measured = t - (-(R + 0.5 * thickness) - watch["bullet"].pose.p_WB.x()) / along;
    worst = std::max(worst, std::abs(measured - hit));
  }
  sheet.error("time of impact at 1000 m/s", "s", worst, closedForm(1e-12));

  int passed = 0;
  for (const double step : {kFrame, 1.0 / 240.0, 1.0 / 30.0}) {
    for (const double e : {0.0, 0.5, 1.0}) {
      for (int shot = 0; shot < 24; ++shot) {
        SceneDef scene = emptySpace(step);
        scene.bodies = {fixedBox("paper", Vec3(1e-3, 200.0, 200.0), Vec3::Zero()),
                        ball("bullet", 0.01, Vec3(-3.0 - 0.37 * shot, 0.0, 0.0))};
        scene.bodies[1].material.restitution = e;
        scene.bodies[1].twist = {1000.0 * Vec3(std::cos(0.04 * shot), std::sin(0.04 * shot), 0.0),
                                 Vec3(0.0, 0.0, 10.0 * shot)};
        Watch watch(scene, sheet.setting());
        bool through = false;
        for (int k = 0; k < 6; ++k) watch.step(), through |= watch["bullet"].pose.p_WB.x() > 0.0;
        passed += through;
      }
    }
  }
  sheet.error("bullets of 216 that pass the paper", "", passed, every(0.0));

  int sticks = 0;
  for (int shot = 0; shot < 24; ++shot) {
    SceneDef scene = emptySpace(kFrame);
    scene.bodies = {fixedBox("wall", Vec3(0.01, 40.0, 40.0), Vec3::Zero()),
                    box("stick", Vec3(1.0, 0.05, 0.05), Vec3(-4.0 - 0.3 * shot, 0.0, 0.0))};
    scene.bodies[1].twist = {Vec3(180.0, 0.0, 0.0), Vec3(0.0, 20.0, 1.3 * shot)};
    scene.bodies[1].material.restitution = shot % 3 * 0.4;
    Watch watch(scene, sheet.setting());
    bool through = false;
    for (int k = 0; k < 30; ++k) watch.step(), through |= watch["stick"].pose.p_WB.x() > 0.0;
    sticks += through;
  }
  sheet.error("spinning sticks of 24 at 180 m/s that pass a wall of 1 cm", "", sticks, every(0.0));
}

// A level rod of half length 1 and half thickness b turns at w above a floor at depth d below it: its end is
// there at the angle th with sin th + b cos th = d.
void spinningRod(Sheet& sheet) {
  const double b = 0.01, depth = 0.5;
  const double norm = std::sqrt(1.0 + b * b), hit = std::asin(depth / norm) - std::atan(b);
  for (const double w : {50.0, 1e3, 1e4}) {
    SceneDef scene = emptySpace(1.05 * hit / w);
    scene.bodies = {floorOf(0.0), box("rod", Vec3(2.0, 2.0 * b, 2.0 * b), Vec3(0.0, 0.0, depth))};
    scene.bodies[1].twist.w_WB.y() = w;
    makeElastic(scene);
    Watch watch(scene, sheet.setting());
    watch.step();
    // From the impact on the centre rises steadily.
    const BodyState rod = watch["rod"];
    const double rise = rod.twist.v_WB.z();
    const double met = rise > 0.0 ? watch.world().time() - (rod.pose.p_WB.z() - depth) / rise : 0.0;
    sheet.error(named("angle at the first contact, %g rad/s", w), "rad", met * w - hit, exact(1e-9));
  }
  int passed = 0;
  for (int shot = 0; shot < 24; ++shot) {
    SceneDef scene = onFloor(kFrame, 0.6);
    scene.bodies.push_back(box("rod", Vec3(2.0, 0.02, 0.02), Vec3(0.0, 0.0, 2.0 + 0.1 * shot)));
    scene.bodies.back().twist = {Vec3(0.0, 0.0, -20.0), Vec3(3.0, 50.0 * std::pow(200.0, shot / 23.0), 7.0)};
    Watch watch(scene, sheet.setting());
    bool through = false;
    for (int k = 0; k < 30; ++k) watch.step(), through |= watch["rod"].pose.p_WB.z() < 0.0;
    passed += through;
  }
  sheet.error("rods of 24 at 50 to 1e4 rad/s that pass the floor", "", passed, every(0.0));
}

/// Where a point is that goes to and fro between -a and a, from 0 at v, after t: the path unfolded.
double unfolded(long double v, long double t, long double a) {
  const long double path = std::remainder(v * t, 4.0L * a);  // in (-2a, 2a]
  if (path > a) return static_cast<double>(2.0L * a - path);
  if (path < -a) return static_cast<double>(-2.0L * a - path);
  return static_cast<double>(path);
}

void closedBox(Sheet& sheet) {
  for (const double speed : {1e3, 1e5}) {
    const Vec3 v = speed * Vec3(std::sqrt(2.0), std::sqrt(3.0), std::sqrt(5.0)).normalized();
    SceneDef scene = room(2.0);
    scene.bodies.push_back(ball("ball", 0.1, Vec3::Zero()));
    scene.bodies.back().twist.v_WB = v;
    makeElastic(scene);
    Watch watch(scene, sheet.setting());
    watch.run(sheet.length(speed > 1e4 ? 0.1 : 1.0, 10.0));
    double worst = 0.0, bounces = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double t = watch.world().time();
      worst = std::max(worst, std::abs(watch["ball"].pose.p_WB[axis] - unfolded(v[axis], t, 0.9L)));
      bounces += v[axis] * t / 1.8;
    }
    sheet.error(named("place per bounce, of the size, at %g m/s", speed), "", worst / 2.0 / bounces,
                closedForm(1e-13));
    sheet.error(named("energy, relative, at %g m/s", speed), "",
                watch["ball"].twist.v_WB.squaredNorm() / (speed * speed) - 1.0, closedForm(1e-12));
    sheet.check(named("inside at the end, at %g m/s", speed),
                watch["ball"].pose.p_WB.lpNorm<Eigen::Infinity>() <= 0.9 + 1e-9, every(0.0));
  }
}

void simultaneous(Sheet& sheet) {
  for (const int side : {2, 3}) {
    SceneDef scene = emptySpace(kFrame);
    for (int k = 0; k < side * side * side; ++k) {
      const Vec3 cell = Vec3(k % side, k / side % side, k / side / side) - Vec3::Constant(0.5 * (side - 1));
      scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.5, 2.0 * cell));
      scene.bodies.back().twist.v_WB = -3.0 * cell;
    }
    makeElastic(scene);
    Watch watch(scene, sheet.setting());
    watch.run(1.0);
    const Snapshot snapshot = watch.world().snapshot();
    const std::size_t n = snapshot.states.size();
    double worst = 0.0;
    for (std::size_t k = 0; k < n; ++k)  // each has its mirror image through the centre
      worst = std::max(worst, (snapshot.states[k].pose.p_WB + snapshot.states[n - 1 - k].pose.p_WB).norm());
    sheet.error("implosion of " + std::to_string(n) + " balls: asymmetry", "m", worst, closedForm(1e-12));
  }
  SceneDef scene = onFloor(kFrame, 0.0);
  for (int k = 0; k < 1000; ++k)
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.1, Vec3(k % 32, k / 32, 1.1)));
  makeElastic(scene);
  Watch watch(scene, sheet.setting());
  watch.run(1.0);
  const double t = watch.world().time(), t0 = std::sqrt(2.0 / kGravity);
  const double since = t - t0, expected = kGravity * t0 * since - 0.5 * kGravity * since * since;
  double worst = 0.0;
  const Snapshot snapshot = watch.world().snapshot();
  for (std::size_t k = 1; k < snapshot.states.size(); ++k)
    worst = std::max(worst, std::abs(snapshot.states[k].pose.p_WB.z() - 0.1 - expected));
  sheet.error("1000 balls land at once: height after", "m", worst, closedForm(1e-12));
}

void bulletsAtStack(Sheet& sheet) {
  SplitMix64 random(7);
  const int shots = sheet.length(20, 4, 1000);
  int passed = 0;
  double momentum = 0.0;
  for (int shot = 0; shot < shots; ++shot) {
    const bool floating = shot % 2 == 1;  // without floor and gravity the momentum can be weighed
    SceneDef scene = floating ? emptySpace(kFrame) : onFloor(kFrame, 0.5);
    for (int k = 0; k < 10; ++k)
      scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Ones(), Vec3(0.0, 0.0, 0.5 + k)));
    BodyDef bullet =
        ball("bullet", 0.05, Vec3(-10.0, random.uniform(-0.4, 0.4), 4.5 + random.uniform(-0.4, 0.4)));
    bullet.density = 8000.0;
    bullet.twist = {Vec3(500.0, 0.0, 0.0),
                    Vec3(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50))};
    scene.bodies.push_back(bullet);
    Watch watch(scene, sheet.setting());
    const Totals before = watch.world().totals();
    bool through = false;
    for (int k = 0; k < 12; ++k) {
      watch.step();
      through |= watch["bullet"].pose.p_WB.x() > watch["box_4"].pose.p_WB.x() + 0.5;
    }
    passed += through;
    if (floating)
      momentum = std::max(
          momentum, (watch.world().totals().momentum - before.momentum).norm() / before.momentum.norm());
  }
  sheet.error("bullets that pass the stack", "", passed, every(0.0));
  sheet.error("momentum, relative, floating stack", "", momentum, every(1e-10));
}

}  // namespace

std::vector<Case> ccdCases() {
  return {
      {"A54", "Bullet and paper",
       "A ball of R = 1 cm at 1000 m/s meets a wall of 1 mm at 60 Hz (16.7 m a step), at 18 angles; its time "
       "of impact is "
       "(d − R − t/2)/v. 216 shots at three steps and three restitutions, and 24 spinning sticks at 180 m/s.",
       bulletAndPaper},
      {"A55", "Spinning rod",
       "A rod of half length 1 m turns at 50 to 1e4 rad/s half a metre above a floor: its end comes down "
       "where sin θ + b cos "
       "θ = d. 24 rods are thrown down at up to 1e4 rad/s.",
       spinningRod},
      {"A58", "A ball in a closed box",
       "A ball (R = 0.1 m) bounces in a cube of 2 m at 1e3 and 1e5 m/s in an irrational direction, e = 1, "
       "for 10 s (1 and "
       "0.1 s in the tests). Exact: the path unfolded.",
       closedBox},
      {"A59", "Many impacts at once",
       "8 and 27 elastic balls fly together to the centre of a cube; 1000 balls land on the floor at the "
       "same instant.",
       simultaneous},
      {"A62", "Bullets at a stack",
       "1000 bullets (20 in the tests) of R = 5 cm at 500 m/s hit the fifth box of ten, at random places; "
       "every other stack "
       "floats without gravity, so that the momentum can be weighed.",
       bulletsAtStack},
  };
}

}  // namespace rbs::stability

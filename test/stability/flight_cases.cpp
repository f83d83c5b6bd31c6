// SPDX-License-Identifier: BSD-3-Clause
// Free flight and free rotation.
#include "measure.h"

#include "base/random.h"

#include <algorithm>

namespace rbs::stability {
namespace {

using namespace test;

BodyDef spinning(const Vec3& size, const Vec3& w_W) {
  BodyDef def = box("body", size, Vec3::Zero());
  def.mass = 1.0;
  def.twist.w_WB = w_W;
  return def;
}

SceneDef inSpace(double step, const BodyDef& body) {
  SceneDef scene = emptySpace(step);
  scene.bodies.push_back(body);
  return scene;
}

double relativeChange(const Vec3& now, const Vec3& before) {
  return (now - before).norm() / before.norm();
}

FreeTop topOf(const World& world) {
  const Snapshot snapshot = world.snapshot();
  return {snapshot.bodies->front().inertia, snapshot.states.front().pose.q_WB,
          snapshot.states.front().twist.w_WB};
}

void projectile(Sheet& sheet) {
  for (const double step : {1.0 / 10.0, kFrame, 1e-3}) {
    SceneDef scene;
    scene.step = step;
    scene.bodies.push_back(ball("shot", 0.5, Vec3(1.0, 2.0, 3.0)));
    scene.bodies.back().mass = 1.0;
    scene.bodies.back().twist.v_WB = {10.0, 5.0, 20.0};
    Watch watch(scene, sheet.setting());
    watch.run(10.0);
    const double t = watch.world().time();
    const Vec3 exact_place =
        Vec3(1.0, 2.0, 3.0) + t * Vec3(10.0, 5.0, 20.0) + 0.5 * t * t * Vec3(0.0, 0.0, -kGravity);
    sheet.error("position after 10 s, relative, steps of 1/" + std::to_string(std::lround(1.0 / step)) + " s",
                "", (watch["shot"].pose.p_WB - exact_place).lpNorm<Eigen::Infinity>() / exact_place.norm(),
                every(1e-12));
  }
}

void principalSpin(Sheet& sheet) {
  for (const Vec3& w : {Vec3(0.0, 0.0, 1000.0), Vec3(1000.0, 0.0, 0.0)}) {
    Watch watch(inSpace(kFrame, spinning(Vec3(0.2, 0.4, 0.6), w)), sheet.setting());
    const Totals before = watch.world().totals();
    watch.run(sheet.length(10.0, 100.0));
    const long double turned = 1000.0L * watch.world().time();
    const double angle = static_cast<double>(std::remainder(turned, 2.0L * 3.14159265358979323846264338L));
    const std::string axis = w.z() > 0.0 ? ", smallest moment" : ", largest moment";
    sheet.error("angle" + axis, "rad",
                angleBetween(Quat(Eigen::AngleAxisd(angle, w.normalized())), watch["body"].pose.q_WB),
                exact(1e-9));
    sheet.error("energy, relative" + axis, "",
                watch.world().totals().kinetic_energy / before.kinetic_energy - 1.0, exact(1e-13));
  }
}

// The axis turns about L at |L|/I1, and the body about its own axis against that at (I1 - I3)/I1 w3.
void symmetricTop(Sheet& sheet) {
  for (const Vec3& size : {Vec3(0.2, 0.2, 0.6), Vec3(1.0, 1.0, 0.1)}) {
    Watch watch(inSpace(kFrame, spinning(size, Vec3(1.0, 0.0, 10.0))), sheet.setting());
    const Totals before = watch.world().totals();
    watch.run(sheet.length(20.0, 100.0));
    const double t = watch.world().time();
    const double I1 = (size.x() * size.x() + size.z() * size.z()) / 12.0, I3 = size.x() * size.x() / 6.0;
    const Vec3 L(I1 * 1.0, 0.0, I3 * 10.0);
    const Quat expected = Quat(Eigen::AngleAxisd(L.norm() / I1 * t, L.normalized())) *
                          Quat(Eigen::AngleAxisd((I1 - I3) / I1 * 10.0 * t, Vec3::UnitZ()));
    const std::string which = size.z() > size.x() ? ", rod" : ", plate";
    sheet.error("orientation" + which, "rad", angleBetween(expected, watch["body"].pose.q_WB),
                fastAndExact(1e-3, 1e-10));
    sheet.error("angular momentum, relative" + which, "",
                relativeChange(watch.world().totals().angular_momentum, before.angular_momentum),
                exact(1e-13));
  }
}

struct Tumble {
  double energy = 0.0, momentum = 0.0, orientation = 0.0;  ///< the worst over the run; orientation at its end
};

Tumble tumble(Fidelity setting, double step, const Vec3& size, const Vec3& w, double seconds) {
  Watch watch(inSpace(step, spinning(size, w)), setting);
  FreeTop top = topOf(watch.world());
  const Totals before = watch.world().totals();
  Tumble worst;
  const long steps = std::lround(seconds / step);
  for (long k = 0; k < steps; ++k) {
    watch.step();
    const Totals now = watch.world().totals();
    worst.energy = std::max(worst.energy, std::abs(now.kinetic_energy / before.kinetic_energy - 1.0));
    worst.momentum = std::max(worst.momentum, relativeChange(now.angular_momentum, before.angular_momentum));
  }
  top.run(static_cast<long double>(watch.world().time()),
          std::min(static_cast<long double>(step) / 64.0L, 0.002L / w.norm()));
  worst.orientation = angleBetween(top.orientation(), watch["body"].pose.q_WB);
  return worst;
}

void slowTumble(Sheet& sheet) {
  const Tumble worst = tumble(sheet.setting(), 0.01, Vec3(0.2, 0.4, 0.6), Vec3(1.0, 2.0, 3.0), 5.0);
  sheet.error("energy, relative", "", worst.energy, exact(1e-9));
  sheet.error("angular momentum, relative", "", worst.momentum, exact(1e-14));
  sheet.error("orientation after 5 s", "rad", worst.orientation, exact(5e-8));
}

// Where the spin about the middle axis changes its sign, from the state before the step in which it does.
std::vector<double> flipTimes(Watch& watch, double seconds) {
  std::vector<double> times;
  const double step = watch.world().scene().step;
  FreeTop before = topOf(watch.world());
  while (watch.world().time() < seconds) {
    const double start = watch.world().time();
    watch.step();
    const FreeTop after = topOf(watch.world());
    if (before.spinInBody().y() * after.spinInBody().y() < 0.0) {
      double early = 0.0, late = step;
      while (late - early > 1e-9) {
        const double middle = 0.5 * (early + late);
        FreeTop top = before;
        top.run(middle, 1e-4L);
        (top.spinInBody().y() * before.spinInBody().y() > 0.0 ? early : late) = middle;
      }
      times.push_back(start + late);
    }
    before = after;
  }
  return times;
}

// The same, of the free top alone.
std::vector<double> exactFlipTimes(FreeTop top, double seconds) {
  std::vector<double> times;
  const long double step = 2e-5L;
  for (long k = 0; k < std::lround(seconds / static_cast<double>(step)); ++k) {
    const double before = top.spinInBody().y();
    top.run(step, step);
    const double after = top.spinInBody().y();
    if (before * after < 0.0) times.push_back(static_cast<double>(step) * (k + before / (before - after)));
  }
  return times;
}

void dzhanibekov(Sheet& sheet) {
  for (const double step : {kFrame, 1.0 / 240.0}) {
    const std::string at = ", steps of 1/" + std::to_string(std::lround(1.0 / step)) + " s";
    SceneDef scene = fromCatalogue("spinning_box");
    scene.step = step;
    Watch watch(scene, sheet.setting());
    FreeTop top = topOf(watch.world());
    const Totals before = watch.world().totals();
    const std::vector<double> times = flipTimes(watch, 20.0), expected = exactFlipTimes(top, 20.0);
    sheet.value("flips in 20 s" + at, "", times.size(), expected.size(), every(0.0));
    double worst = times.size() == expected.size() ? 0.0 : 1.0;
    for (std::size_t k = 0; k < std::min(times.size(), expected.size()); ++k)
      worst = std::max(worst, std::abs(times[k] - expected[k]));
    sheet.error("times of the flips" + at, "s", worst, exact(1e-4));
    const Totals after = watch.world().totals();
    sheet.error("energy, relative" + at, "", after.kinetic_energy / before.kinetic_energy - 1.0,
                fastAndExact(1e-2, 1e-9));
    sheet.error("angular momentum, relative" + at, "",
                relativeChange(after.angular_momentum, before.angular_momentum), exact(1e-14));
    top.run(static_cast<long double>(watch.world().time()), 1e-4L);
    sheet.error("orientation after 20 s" + at, "rad",
                angleBetween(top.orientation(), watch.world().snapshot().states[0].pose.q_WB), exact(1e-4));
  }
}

void violentTumble(Sheet& sheet) {
  const Tumble worst = tumble(sheet.setting(), kFrame, Vec3(0.2, 0.4, 0.6), Vec3(10.0, 20.0, 30.0), 10.0);
  sheet.error("energy, relative", "", worst.energy, exact(1e-7));
  sheet.error("angular momentum, relative", "", worst.momentum, exact(1e-13));
  sheet.error("orientation after 10 s", "rad", worst.orientation, exact(1e-4));
}

void needleAndDisc(Sheet& sheet) {
  const Vec3 w = Vec3::Constant(200.0 / std::sqrt(3.0));
  for (const Vec3& size : {Vec3(2.0, 0.02, 0.02), Vec3(0.02, 2.0, 2.0)}) {
    const std::string which = size.x() > size.y() ? ", needle" : ", disc";
    Watch watch(inSpace(kFrame, spinning(size, w)), sheet.setting());
    const Totals before = watch.world().totals();
    watch.run(10.0);
    const Totals after = watch.world().totals();
    sheet.error("energy, relative" + which, "", after.kinetic_energy / before.kinetic_energy - 1.0,
                exact(1e-6));
    sheet.error("angular momentum, relative" + which, "",
                relativeChange(after.angular_momentum, before.angular_momentum), exact(1e-13));
    watch.writeFinite(sheet);
  }
}

void longRun(Sheet& sheet) {
  SceneDef scene = emptySpace(kFrame);
  SplitMix64 random(5);
  for (int k = 0; k < 51; ++k) {
    BodyDef def = box("box_" + std::to_string(k), Vec3(0.2, 0.4, 0.6), Vec3(1e5 * k, 0.0, 0.0));
    for (int axis = 0; axis < 3; ++axis) {
      def.twist.v_WB[axis] = random.uniform(-1.0, 1.0);
      def.twist.w_WB[axis] = random.uniform(-5.0, 5.0);
    }
    scene.bodies.push_back(def);
  }
  scene.bodies[0].twist.w_WB = {0.01, 10.0, 0.01};
  Watch watch(scene, sheet.setting());
  const Snapshot before = watch.world().snapshot();
  watch.run(sheet.length(50.0, 1000.0));
  const Snapshot after = watch.world().snapshot();
  const auto spinMomentum = [](const Snapshot& snapshot, std::size_t k) {
    const BodyState& state = snapshot.states[k];
    const Vec3 L_B =
        (*snapshot.bodies)[k].inertia.cwiseProduct(state.pose.q_WB.conjugate() * state.twist.w_WB);
    return Vec3(state.pose.q_WB * L_B);
  };
  double momentum = 0.0, spin = 0.0, energy = 0.0, unit = 0.0;
  for (std::size_t k = 0; k < after.states.size(); ++k) {
    const BodyState &now = after.states[k], &was = before.states[k];
    momentum = std::max(momentum, relativeChange(now.twist.v_WB, was.twist.v_WB));
    const Vec3 L_now = spinMomentum(after, k), L_was = spinMomentum(before, k);
    spin = std::max(spin, relativeChange(L_now, L_was));
    energy = std::max(energy, std::abs(L_now.dot(now.twist.w_WB) / L_was.dot(was.twist.w_WB) - 1.0));
    unit = std::max(unit, std::abs(now.pose.q_WB.norm() - 1.0));
  }
  sheet.error("momentum, relative, worst body", "", momentum, exact(1e-12));
  sheet.error("angular momentum, relative, worst body", "", spin, exact(1e-12));
  sheet.error("energy of rotation, relative, worst body", "", energy, exact(1e-8));
  sheet.error("length of the quaternion less 1", "", unit, every(1e-15));
}

void thinBodies(Sheet& sheet) {
  for (const Vec3& size : {Vec3(1.0, 1.0, 1e-9), Vec3(1.0, 0.0, 0.0)}) {
    bool refused = false;
    try {
      World world(inSpace(kFrame, spinning(size, Vec3::Ones())));
    } catch (const InvalidInput&) {
      refused = true;
    }
    sheet.check(size.y() > 0.0 ? "a plate 1e-9 m thick is refused" : "a rod without width is refused",
                refused, every(0.0));
  }
  for (const Vec3& size : {Vec3(1.0, 1.0, 1e-6), Vec3(1.0, 1e-6, 1e-6)}) {
    Watch watch(inSpace(kFrame, spinning(size, Vec3(1.0, 2.0, 3.0))), sheet.setting());
    const Totals before = watch.world().totals();
    watch.run(5.0);
    const std::string which = size.y() > 0.5 ? ", plate of 1e-6 m" : ", rod of 1e-6 m";
    watch.writeFinite(sheet);
    sheet.error("energy, relative" + which, "",
                watch.world().totals().kinetic_energy / before.kinetic_energy - 1.0, exact(1e-6));
  }
}

}  // namespace

std::vector<Case> flightCases() {
  return {
      {"A01", "Projectile",
       "A ball of 1 kg thrown at (10, 5, 20) m/s flies for 10 s at steps of 1/10, 1/60 and 1/1000 s. "
       "Exact: x0 + v0 t + g t²/2.",
       projectile},
      {"A02", "Spin about a principal axis",
       "A box of 0.2 × 0.4 × 0.6 m spins at 1000 rad/s about its axis of the smallest, then of the largest "
       "moment: "
       "16.7 rad a step of 1/60 s. Exact: the spin stays, the angle is ωt.",
       principalSpin},
      {"A03", "Symmetric top",
       "A square rod (0.2 × 0.2 × 0.6 m) and a square plate (1 × 1 × 0.1 m) spin freely at (1, 0, 10) rad/s. "
       "Exact: precession about L at |L|/I1 and about the body's axis at (I1 − I3)/I1 ω3.",
       symmetricTop},
      {"A04", "Slow tumble",
       "A box of 0.2 × 0.4 × 0.6 m tumbles freely from (1, 2, 3) rad/s for 5 s at steps of 0.01 s. "
       "Reference: a "
       "Runge-Kutta integration in long double at tiny steps, as in A05 and A06.",
       slowTumble},
      {"A05", "Dzhanibekov's flips",
       "The same box (scene spinning_box) spins about its unstable middle axis, (0.01, 10, 0.01) rad/s, for "
       "20 s, and "
       "turns over six times. A flip is where the spin about the middle axis, seen from the body, changes "
       "its sign.",
       dzhanibekov},
      {"A06", "Violent tumble", "The same box from (10, 20, 30) rad/s for 10 s at 60 Hz: 0.62 rad a step.",
       violentTumble},
      {"A07", "Needle and disc",
       "A needle of 2 × 0.02 × 0.02 m and a disc of 0.02 × 2 × 2 m spin at 200 rad/s about (1, 1, 1) for 10 "
       "s at 60 Hz.",
       needleAndDisc},
      {"A08", "Long run",
       "51 free boxes, the one of A05 among them, drift and tumble for 1000 s (50 s in the tests) at 60 Hz.",
       longRun},
      {"A09", "Thin bodies", "Sizes below 1e-6 m are refused. A plate and a rod of 1e-6 m tumble for 5 s.",
       thinBodies},
  };
}

}  // namespace rbs::stability

// SPDX-License-Identifier: BSD-3-Clause
// The same physics in other sizes, far from the origin, and with large beside small.
#include "measure.h"

#include "rigid_body_sim/queries.h"

#include <algorithm>

namespace rbs::stability {
namespace {

using namespace test;

void bigAndSmall(Sheet& sheet) {
  struct Trial {
    const char* what;
    Vec3 big;
    double small, depth;
  };
  for (const Trial& trial : {Trial{"0.2 m on 200 m", Vec3(200.0, 200.0, 200.0), 0.2, 1e-4},
                             Trial{"0.2 m on a plate of 100 m", Vec3(100.0, 100.0, 0.5), 0.2, 7.54e-4},
                             Trial{"1 mm on 1 km", Vec3(1e3, 1e3, 1e3), 1e-3, 1e-6}}) {
    SceneDef scene;
    scene.step = kFrame * std::sqrt(trial.small);
    scene.bodies = {
        fixedBox("big", trial.big, Vec3(0.0, 0.0, -0.5 * trial.big.z())),
        box("small", Vec3::Constant(trial.small), Vec3(0.3, 0.2, 0.5 * trial.small - trial.depth))};
    Watch overlap(scene, sheet.setting());
    const Snapshot before = overlap.world().snapshot();
    const double found = -closestPoints(before, before.states[0].id, before.states[1].id).distance;
    // To the rounding of the large coordinate.
    const double rounding = 1e-15 * trial.big.z() / trial.depth;
    sheet.error(std::string("depth of an overlap, relative: ") + trial.what, "", found / trial.depth - 1.0,
                every(std::max(1e-9, rounding)));

    scene.bodies[1].pose.p_WB.z() = 0.5 * trial.small;
    Watch watch(scene, sheet.setting());
    watch.run(60 * scene.step);
    const Vec3 early = watch["small"].pose.p_WB;
    watch.run(60 * scene.step);
    sheet.value(std::string("contact points: ") + trial.what, "", watch.world().snapshot().contacts.size(),
                4.0, every(0.0));
    sheet.error(std::string("drift at rest, of the size: ") + trial.what, "",
                (watch["small"].pose.p_WB - early).norm() / trial.small,
                exact(std::max(1e-9, 1e-15 * trial.big.x() / trial.small)));
  }
}

SceneDef smallStack(double size, const Vec3& origin) {
  SceneDef scene;
  scene.step = kFrame;
  scene.bodies.push_back(
      fixedBox("floor", size * Vec3(20.0, 20.0, 1.0), origin - 0.5 * size * Vec3::UnitZ()));
  for (int k = 0; k < 5; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), size * Vec3::Ones(),
                               origin + size * Vec3(0.1 * (k % 2), 0.0, 0.55 + 1.05 * k)));
  return scene;
}

void farAway(Sheet& sheet) {
  std::vector<Vec3> near;
  std::size_t contacts_near = 0;
  for (const double distance : {0.0, 1e3, 1e5, 1e7}) {
    const Vec3 origin(distance, 0.5 * distance, 0.0);
    Watch watch(smallStack(1.0, origin), sheet.setting());
    watch.run(2.0);
    const Snapshot snapshot = watch.world().snapshot();
    if (distance == 0.0) {
      for (const BodyState& state : snapshot.states) near.push_back(state.pose.p_WB);
      contacts_near = snapshot.contacts.size();
      continue;
    }
    double worst = 0.0;
    for (std::size_t k = 0; k < near.size(); ++k)
      worst = std::max(worst, (snapshot.states[k].pose.p_WB - origin - near[k]).norm());
    sheet.error(named("places after 2 s at %g m", distance), "m", worst, fastAndExact(1e-3, 1e-6));
    sheet.value(named("contact points at %g m", distance), "", snapshot.contacts.size(), contacts_near,
                fastAndExact(0.0, 0.0));
  }
}

/// Places and velocities of a scene after 60 steps, in units of size s, with time scaled by `time`.
std::vector<double> dimensionless(SceneDef scene, Fidelity setting, double s, double time) {
  scene.step *= time;
  scene.gravity *= s / (time * time);
  for (BodyDef& def : scene.bodies) {
    if (!std::holds_alternative<Plane>(def.shape)) {
      def.mass = kDefaultDensity * volume(def.shape);
      def.shape = scaled(def.shape, s);
    }
    def.pose.p_WB *= s;
    def.twist.v_WB *= s / time;
    def.twist.w_WB /= time;
  }
  Watch watch(scene, setting);
  std::vector<double> result;
  for (int k = 0; k < 60; ++k) watch.step();
  for (const BodyState& state : watch.world().snapshot().states) {
    for (int axis = 0; axis < 3; ++axis) {
      result.push_back(state.pose.p_WB[axis] / s);
      result.push_back(state.twist.v_WB[axis] * time / s);
      result.push_back(state.twist.w_WB[axis] * time);
    }
  }
  return result;
}

void scaleSweep(Sheet& sheet) {
  SceneDef stack = onFloor(kFrame, 0.5), slope = stack, bounce = stack;
  for (int k = 0; k < 5; ++k)
    stack.bodies.push_back(box("box_" + std::to_string(k), Vec3::Ones(), Vec3(0.0, 0.0, 0.5 + k)));
  slope.gravity = slopeGravity(std::atan(0.505));
  slope.bodies.push_back(box("slides", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  slope.bodies.push_back(box("stays", Vec3::Ones(), Vec3(0.0, 3.0, 0.5)));
  slope.bodies[1].material.friction = 0.5, slope.bodies[2].material.friction = 0.6;
  bounce.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 1.5)));
  bounce.bodies.back().material.restitution = 0.5;
  bounce.bodies.push_back(box("tumbles", Vec3(1.0, 0.6, 0.4), Vec3(3.0, 0.0, 1.0)));
  bounce.bodies.back().twist.w_WB = {1.0, 2.0, 0.5};
  struct Trial {
    const char* what;
    const SceneDef* scene;
  };
  for (const Trial& trial :
       {Trial{"stack", &stack}, Trial{"slope", &slope}, Trial{"bounce and tumble", &bounce}}) {
    const std::vector<double> base = dimensionless(*trial.scene, sheet.setting(), 1.0, 1.0);
    // Powers of four, whose roots are exact, change no digit: there the results are equal to the last bit
    // unless something has a size of its own.
    for (const double s : {1e-6, 1e-3, 0x1p-10, 0x1p10, 1e3, 1e6}) {
      // Steps are at most 1 s and speeds at most 1e6 m/s, so that the largest scene scales gravity too.
      const double time = s < 1e4 ? std::sqrt(s) : 30.0;
      if (s < 1e-5 && trial.scene == &bounce) continue;  // parts below 1e-6 m are refused
      const std::vector<double> scaled_result = dimensionless(*trial.scene, sheet.setting(), s, time);
      double worst = 0.0;
      for (std::size_t k = 0; k < base.size(); ++k)
        worst = std::max(worst, std::abs(scaled_result[k] - base[k]));
      sheet.error(std::string(trial.what) + named(" at a scale of %g", s), "", worst,
                  fastAndExact(1e-9, 1e-9));
    }
  }
}

}  // namespace

std::vector<Case> scaleCases() {
  return {
      {"A49", "Large and small",
       "A box of 0.2 m on one of 200 m and on a plate of 100 × 100 × 0.5 m, and 1 mm on 1 km: the depth of a "
       "given overlap, "
       "four contact points at rest, and no drift.",
       bigAndSmall},
      {"A50", "Far from the origin",
       "A stack of five boxes falls together 1e3, 1e5 and 1e7 m from the origin: as at the origin, to the "
       "rounding there.",
       farAway},
      {"A51", "Scale sweep",
       "A stack, a box on a slope at 1.01 of the threshold beside one that stays, and bouncing and tumbling "
       "bodies in sizes of "
       "1e-6 to 1e6 m, times scaled by the root (at 1e6 gravity is scaled too): the same dimensionless "
       "places and "
       "velocities after 60 steps.",
       scaleSweep},
  };
}

}  // namespace rbs::stability

// SPDX-License-Identifier: BSD-3-Clause
// Energy, jitter, step sizes and determinism.
#include "measure.h"

#include "rigid_body_sim/scenes.h"

#include <algorithm>

namespace rbs::stability {
namespace {

using namespace test;

// A scene is passive when nothing works on it: neither wind nor a led body.
bool isPassive(const SceneDef& scene) {
  const bool led = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                               [](const BodyDef& body) { return body.kind == BodyKind::Kinematic; });
  return !scene.wind && !led;
}

void energyAudit(Sheet& sheet) {
  for (const SceneEntry& entry : listScenes(RBS_SCENES)) {
    const SceneDef scene = fromCatalogue(entry.name);
    if (!isPassive(scene)) continue;
    Watch watch(scene, sheet.setting());
    // As many steps as make the scenes cost about the same.
    watch.run(sheet.length(std::clamp(600.0 / scene.bodies.size(), 2.0, 5.0),
                           scene.bodies.size() > 30 ? 0.1 : 0.5, 10.0));
    sheet.error("gained in a step, of its scale: " + entry.name, "", watch.growthInAStep(), exact(1e-9));
    Bound in_all = fastAndExact(1e-3, 1e-6);
    in_all.preview = 1e-3;
    sheet.error("gained in all, of its scale: " + entry.name, "", watch.growthInAll(), in_all);
  }
}

void jitter(Sheet& sheet) {
  for (const char* name : {"tower", "pyramid", "card_house", "jenga"}) {
    // The large ones take minutes at the exact settings.
    if (sheet.isExact() && !sheet.length(false, true) && name != std::string("tower")) continue;
    Watch watch(fromCatalogue(name), sheet.setting());
    watch.run(sheet.length(4.0, 10.0));
    double sum = 0.0;
    for (int k = 0; k < 60; ++k) {
      watch.step();
      for (const BodyState& state : watch.world().snapshot().states)
        sum += state.twist.v_WB.squaredNorm() / watch.world().snapshot().states.size() / 60.0;
    }
    sheet.error(std::string("rms speed at rest: ") + name, "m/s", std::sqrt(sum),
                fastAndReference(1e-4, 1e-12));
  }

  // A small push sideways on a box that lies without friction moves it as the impulse says.
  SceneDef scene = onFloor(kFrame, 0.0);
  scene.bodies.push_back(box("box", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  scene.bodies.back().material.friction = 0.0;
  Watch watch(scene, sheet.setting());
  watch.run(3.0);
  const BodyId id = watch.world().find("box");
  const double impulse = 1e-6 * 1000.0 * kGravity * kFrame;
  watch.world().applyImpulse(id, Vec3(impulse, 0.0, 0.0), watch["box"].pose.p_WB);
  watch.run(1.0);
  sheet.error("a push of 1e-6 m g h: speed after, relative", "",
              watch["box"].twist.v_WB.x() / (impulse / 1000.0) - 1.0, every(1e-6));
}

// How errors fall with the step: stop of a sliding box and of a ball that comes to roll.
void stepSweep(Sheet& sheet) {
  std::vector<double> steps{1.0 / 10.0, 1.0 / 30.0, kFrame, 1.0 / 240.0, 1e-3};
  if (sheet.length(false, true)) steps.push_back(1e-5);
  for (const double step : steps) {
    SceneDef scene = onFloor(step, 0.4);
    scene.bodies.push_back(box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1)));
    scene.bodies.back().twist.v_WB.x() = 5.0;
    scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 5.0, 0.5)));
    scene.bodies.back().twist.v_WB.x() = 7.0;
    for (BodyDef& def : scene.bodies) def.material.friction = 0.4;
    Watch watch(scene, sheet.setting());
    watch.run(3.0);
    const std::string at = named(", steps of %.3g s", step);
    sheet.error("braking distance, relative" + at, "",
                watch["box"].pose.p_WB.x() / (25.0 / (0.8 * kGravity)) - 1.0, exact(1e-6));
    sheet.error("speed of rolling, relative" + at, "", watch["ball"].twist.v_WB.x() / 5.0 - 1.0, exact(1e-9));
    watch.writeFinite(sheet);
  }
}

void longStability(Sheet& sheet) {
  const double seconds = sheet.length(10.0, 0.2, 3600.0);
  for (const char* name : {"tower", "card_house"}) {
    Watch watch(fromCatalogue(name), sheet.setting());
    watch.run(sheet.length(5.0, 0.2, 5.0));
    const Snapshot early = watch.world().snapshot();
    watch.run(seconds);
    const Snapshot late = watch.world().snapshot();
    double moved = 0.0;
    for (std::size_t k = 0; k < late.states.size(); ++k)
      moved = std::max(moved, (late.states[k].pose.p_WB - early.states[k].pose.p_WB).norm());
    sheet.error(std::string("movement: ") + name, "m", moved, fastAndExact(5e-3, 1e-4));
    watch.writeFinite(sheet);
  }
}

std::uint64_t hashAfter(const SceneDef& scene, int steps) {
  World world(scene);
  for (int k = 0; k < steps; ++k) world.step();
  return world.stateHash();
}

void equalBits(Sheet& sheet) {
  for (const char* name : {"playground", "windy_day", "dominoes", "newtons_cradle", "tower", "shapes"}) {
    SceneDef scene = fromCatalogue(name);
    scene.fidelity = sheet.setting();
    const int steps = sheet.length(60, 10, 600);
    const std::uint64_t hash = hashAfter(scene, 2 * steps);
    sheet.check(std::string("two runs: ") + name, hashAfter(scene, 2 * steps) == hash, every(0.0));

    World world(scene);
    for (int k = 0; k < steps; ++k) world.step();
    const SceneFile file = parseScene(writeScene(world.capture(), world.captureState()), "saved.yaml");
    World resumed(file.scene, file.state);
    for (int k = 0; k < steps; ++k) resumed.step();
    sheet.check(std::string("saved in the middle as text and resumed: ") + name, resumed.stateHash() == hash,
                every(0.0));
  }

  // The order in which bodies that do not touch are made does not show in what they do.
  SceneDef scene = fromCatalogue("boxes_on_slope"), turned = scene;
  std::reverse(turned.bodies.begin(), turned.bodies.end());
  Watch one(scene, sheet.setting()), two(turned, sheet.setting());
  one.run(2.0), two.run(2.0);
  double worst = 0.0;
  for (const BodyDef& def : scene.bodies)
    worst = std::max(worst, (one[def.name].pose.p_WB - two[def.name].pose.p_WB).norm());
  sheet.error("bodies made in the opposite order: places", "m", worst, exact(1e-9));
}

// Two worlds that differ by 1e-12 m drift apart at a rate of their own; shown, since it is physics.
void chaos(Sheet& sheet) {
  SceneDef scene = fromCatalogue("elastic_666"), moved = scene;
  scene.step = moved.step = 0.01;
  moved.bodies[1].pose.p_WB.x() += 1e-12;
  Watch one(scene, sheet.setting()), two(moved, sheet.setting());
  double from = 0.0, apart = 0.0;
  while (one.world().time() < sheet.length(4.0, 0.3, 4.0)) {
    one.step(), two.step();
    const Snapshot a = one.world().snapshot(), b = two.world().snapshot();
    apart = 0.0;
    for (std::size_t k = 0; k < a.states.size(); ++k)
      apart = std::max(apart, (a.states[k].pose.p_WB - b.states[k].pose.p_WB).norm());
    if (from == 0.0 && apart > 1e-10) from = one.world().time();
    if (apart > 1e-4) break;
  }
  sheet.error("rate at which two runs part from 1e-10 to 1e-4 m", "1/s",
              apart > 1e-4 ? std::log(1e6) / std::max(1e-9, one.world().time() - from) : 0.0, shown());
}

}  // namespace

std::vector<Case> determinismCases() {
  return {
      {"A75", "Energy audit",
       "Every passive scene of the catalogue for 10 s (in the tests 2 to 5 s, by its number of bodies): how "
       "much energy "
       "it gains in a step and above the start. The scale is its kinetic energy at the start and its weight "
       "times the "
       "range of its heights.",
       energyAudit},
      {"A76", "Jitter",
       "The root-mean-square speed over a second of tower, pyramid, card_house and jenga at rest, without "
       "sleeping; then a push "
       "of 1e-6 m g h on a resting box without friction.",
       jitter},
      {"A77", "Step sweep",
       "A box slides to a stop and a ball from sliding to rolling at steps of 1/10 to 1e-3 s (1e-5 s in the "
       "full run).",
       stepSweep},
      {"A78", "For an hour",
       "Scenes tower and card_house for an hour (10 s in the tests), after 5 s to settle.", longStability},
      {"A79", "Determinism",
       "Six scenes twice; saved in the middle as text and resumed; and bodies made in the opposite order.",
       equalBits},
      {"A80", "Chaos",
       "Scene elastic_666 twice, one ball moved by 1e-12 m: the rate at which the two part is shown.", chaos},
  };
}

}  // namespace rbs::stability

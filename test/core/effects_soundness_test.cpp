// What detection leaves out does not matter: random scenes run as detected, and with every additive effect forced on,
// and end in the same place.
//
// Forced on, an effect that a scene does not call for adds zeros: coefficients that are zero, a density that is
// zero, torques that vanish. So the two runs differ by rounding (a solve of a box that feels no air, a turn that is
// summed up instead of evaluated), and where a solver stops at its tolerance, by that. The windows are short, but an
// impact or a stop of sliding may still blow such a difference up. How much is measured beside it, by eight more runs of
// the scene whose velocities are changed by as much as the setting leaves open (bodies that an impact has left
// touching go on as a contact or as another impact by the sign of a rounding error; eight runs meet both): the forced run may go as far from the
// detected one as ten times these do, and the window ends where they go apart by more than 1e-7, since then chaos
// decides. A failure prints the smallest scene found that still fails.
#include "make_scene.h"
#include "random.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace rbs;
using namespace rbs::test;

namespace {

constexpr int kScenes = 1000, kSteps = 12, kNudges = 8;

Shape randomShape(SplitMix64& random) {
  const double size = random.uniform(0.2, 0.6);
  switch (random.next() % 5) {
    case 0:
      return Box{{size, random.uniform(0.5, 1.0) * size, size}};
    case 1:
      return Capsule{0.3 * size, 0.4 * size};
    case 2:
      return Cylinder{0.4 * size, 0.4 * size};
    default:
      return Sphere{0.5 * size};
  }
}

SceneDef randomScene(std::uint64_t seed) {
  SplitMix64 random(seed);
  const auto chance = [&](double share) { return random.uniform() < share; };
  SceneDef scene;
  scene.fidelity = kFidelities[random.next() % kFidelities.size()];
  if (chance(0.3)) scene.gravity.setZero();
  if (chance(0.3)) scene.air = Air{};
  if (scene.air && chance(0.5)) scene.wind = Wind{};
  if (chance(0.2)) scene.fluid = Fluid{};
  const bool rough = chance(0.5), bouncy = chance(0.3), sticky = chance(0.2), apart = chance(0.2);
  if (chance(0.6)) scene.bodies.push_back(floorOf(rough ? 0.5 : 0.0));
  const int n = 2 + static_cast<int>(random.next() % 6);
  for (int k = 0; k < n; ++k) {
    BodyDef def = body("body_" + std::to_string(k), randomShape(random),
                       {0.7 * (k % 3), 0.7 * (k / 3), random.uniform(0.3, 0.6)});
    def.twist.v_WB = Vec3(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0));
    if (chance(0.5)) def.twist.w_WB = Vec3(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
    def.material.friction = rough ? random.uniform(0.1, 0.9) : 0.0;
    def.material.restitution = bouncy ? random.uniform(0.0, 1.0) : 0.0;
    if (sticky) def.material.rolling_resistance = random.uniform(0.0, 0.05);
    if (chance(0.3)) def.material.drag_coefficient = 0.0;
    if (apart) def.mask = 0;
    scene.bodies.push_back(def);
  }
  return scene;
}

// The effects that add something to what is there already. Collision and impacts are on wherever bodies may meet.
EffectOverrides allAdditive(const SceneDef& scene) {
  EffectOverrides on;
  for (const Effect effect : kEffects) on[effect] = true;
  // Rolling resistance belongs to the soft step alone, so forcing it on chooses that method too.
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(),
                   [](const BodyDef& body) { return body.material.rolling_resistance > 0.0; }))
    on.erase(Effect::Rolling);
  on.erase(Effect::Sleeping);  // which takes something away
  return on;
}

// The largest difference of positions, turns and velocities, as shares of 1 m, 1 rad and 1 m/s.
double difference(const World& a, const World& b) {
  const Snapshot x = a.snapshot(), y = b.snapshot();
  double worst = 0.0;
  for (std::size_t k = 0; k < x.states.size(); ++k) {
    worst = std::max({worst, (x.states[k].pose.p_WB - y.states[k].pose.p_WB).norm(),
                      x.states[k].pose.q_WB.angularDistance(y.states[k].pose.q_WB),
                      (x.states[k].twist.v_WB - y.states[k].twist.v_WB).norm()});
  }
  return worst;
}

// What a setting leaves open in a velocity, as a share: rounding, or the tolerance of its solver.
double leftOpen(Fidelity fidelity) {
  return fidelity == Fidelity::Accurate ? 1e-6 : fidelity == Fidelity::Reference ? 1e-12 : 1e-14;
}

SceneDef nudged(SceneDef scene, double share, SplitMix64& random) {
  for (BodyDef& def : scene.bodies)
    for (Vec3* velocity : {&def.twist.v_WB, &def.twist.w_WB})
      for (int axis = 0; axis < 3; ++axis) (*velocity)[axis] *= 1.0 + share * random.uniform(-1.0, 1.0);
  return scene;
}

struct Comparison {
  double found = 0.0;    // the difference at the end of the window
  double allowed = 0.0;  // and what it may be
  int steps = 0;         // of the window
  bool fails() const { return found > allowed; }
};

Comparison compare(const SceneDef& scene, const SceneDef& other) {
  const double open = leftOpen(scene.fidelity.preset);
  const double chaos = std::max(1e-7, 10.0 * open);
  World a(scene), b(other);
  SplitMix64 random(5);
  std::vector<World> nudges;
  for (int k = 0; k < kNudges; ++k) nudges.emplace_back(nudged(scene, open, random));
  Comparison result;
  for (; result.steps < kSteps && !result.fails(); ++result.steps) {
    a.step(), b.step();
    double spread = open;
    for (World& nudge : nudges) nudge.step(), spread = std::max(spread, difference(a, nudge));
    if (spread > chaos) break;
    result.found = difference(a, b);
    result.allowed = 10.0 * spread;
  }
  return result;
}

SceneDef forced(SceneDef scene) {
  scene.effects = allAdditive(scene);
  return scene;
}

// Takes bodies away as long as it still fails.
SceneDef shrunk(SceneDef scene) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      SceneDef fewer = scene;
      fewer.bodies.erase(fewer.bodies.begin() + static_cast<std::ptrdiff_t>(k));
      if (!compare(fewer, forced(fewer)).fails()) continue;
      scene = fewer;
      smaller = true;
      break;
    }
  }
  return scene;
}

TEST(Soundness, WhatDetectionLeavesOutDoesNotMatter) {
  int exact = 0, cut = 0, failures = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    const SceneDef scene = randomScene(seed);
    const Comparison result = compare(scene, forced(scene));
    exact += result.found == 0.0;
    cut += result.steps < kSteps;
    if (!result.fails()) continue;
    if (++failures <= 5)
      ADD_FAILURE() << "seed " << seed << ", " << fidelityName(scene.fidelity.preset) << ", step " << result.steps << ": "
                    << result.found << " > " << result.allowed << "\n" << writeScene(shrunk(scene));
  }
  EXPECT_EQ(failures, 0);
  EXPECT_LE(cut, kScenes / 10);  // a test whose windows all end early would see nothing
  std::printf("%d scenes: %d equal bit for bit, %d windows cut short by chaos\n", kScenes, exact, cut);
}

// The comparison sees an effect that matters: with drag taken away where there is wind it must fail.
TEST(Soundness, TheComparisonSeesWhatMatters) {
  int seen = 0, windy = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SceneDef scene = randomScene(seed);
    if (!scene.wind) continue;
    ++windy;
    SceneDef calm = scene;
    calm.effects[Effect::Drag] = false;
    seen += compare(scene, calm).fails();
  }
  EXPECT_GT(windy, 3);
  EXPECT_GE(seen, windy - 1);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// What each effect costs, alone and in pairs: nanoseconds a body and step beyond the scene without it.
//
// Two families of 1,000 bodies, so that each effect has something to work on: balls in the air, and balls
// that rest on a floor. An effect is added to the scene by its data, as a user would. All scenes take turns;
// the least time of each counts. Prints CSV: family, effect, second effect (or nothing), cost.
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace rbs;
using Clock = std::chrono::steady_clock;

constexpr int kBodies = 1000, kSteps = 10, kRounds = 15;

struct Addition {
  const char* name;
  std::function<void(SceneDef&)> add;
};

void forAll(SceneDef& scene, const std::function<void(BodyDef&)>& change) {
  for (BodyDef& def : scene.bodies) change(def);
}

SceneDef inTheAir() {
  SceneDef scene;
  scene.gravity.setZero();
  for (int k = 0; k < kBodies; ++k) {
    BodyDef def;
    def.shape = Sphere{0.1};
    def.pose.p_WB = Vec3(k % 32, k / 32, 5.0);
    def.twist = {{0.1, 0.2, 0.0}, {1.0, 2.0, 3.0}};
    def.mask = 0;
    def.material.friction = 0.0;
    scene.bodies.push_back(def);
  }
  return scene;
}

SceneDef onTheFloor() {
  SceneDef scene = inTheAir();
  scene.gravity = {0.0, 0.0, -9.81};
  forAll(scene, [](BodyDef& def) { def.pose.p_WB.z() = 0.1, def.mask = 1, def.group = 2, def.twist = {}; });
  BodyDef floor;
  floor.shape = Plane{};
  floor.kind = BodyKind::Static;
  floor.mask = 2;
  floor.material.friction = 0.0;
  scene.bodies.push_back(floor);
  return scene;
}

const std::vector<Addition> kInTheAir{
    {"gravity", [](SceneDef& s) { s.gravity.z() = -9.81; }},
    {"drag", [](SceneDef& s) { s.air = Air{}; }},
    {"buoyancy",
     [](SceneDef& s) {
       s.fluid = Fluid{1000.0, 5.0}, forAll(s, [](BodyDef& b) { b.material.drag_coefficient = 0.0; });
     }},
    {"rotation", [](SceneDef& s) { s.effects[Effect::Rotation] = true; }},
    {"gyroscopic", [](SceneDef& s) { forAll(s, [](BodyDef& b) {
                                       b.shape = Box{{0.1, 0.15, 0.2}};
                                     }); }},
    {"collision", [](SceneDef& s) { forAll(s, [](BodyDef& b) { b.mask = 1; }); }},
};
const std::vector<Addition> kOnTheFloor{
    {"friction", [](SceneDef& s) { forAll(s, [](BodyDef& b) { b.material.friction = 0.5; }); }},
    {"restitution", [](SceneDef& s) { forAll(s, [](BodyDef& b) { b.material.restitution = 0.5; }); }},
    {"rolling", [](SceneDef& s) { forAll(s, [](BodyDef& b) { b.material.rolling_resistance = 0.01; }); }},
    {"drag", [](SceneDef& s) { s.air = Air{}; }},
};

double nanoseconds(World& world) {
  const auto start = Clock::now();
  for (int k = 0; k < kSteps; ++k) world.step();
  return 1e9 * std::chrono::duration<double>(Clock::now() - start).count() / (kSteps * double(kBodies));
}

void measure(const char* family, const SceneDef& base, const std::vector<Addition>& additions) {
  struct Case {
    int a, b;
    World world;
    double least;
  };
  std::vector<Case> cases;
  const int n = static_cast<int>(additions.size());
  for (int a = -1; a < n; ++a) {
    for (int b = a; b < n; ++b) {
      if (a < 0 && b >= 0) continue;
      SceneDef scene = base;
      if (a >= 0) additions[a].add(scene);
      if (b != a) additions[b].add(scene);
      cases.push_back({a, b, World(scene), std::numeric_limits<double>::infinity()});
    }
  }
  for (Case& one : cases)
    for (int k = 0; k < 60; ++k) one.world.step();  // comes to rest
  for (int round = 0; round < kRounds; ++round) {
    for (Case& one : cases) one.least = std::min(one.least, nanoseconds(one.world));
    std::fprintf(stderr, "\r%s: round %d of %d", family, round + 1, kRounds);
  }
  std::fprintf(stderr, "\n");
  for (const Case& one : cases)
    std::printf("%s,%s,%s,%.2f\n", family, one.a < 0 ? "nothing" : additions[one.a].name,
                one.b == one.a ? "" : additions[one.b].name, one.least);
}

}  // namespace

int main() {
  std::printf("family,effect,second,ns_per_body_and_step\n");
  measure("in the air", inTheAir(), kInTheAir);
  measure("on a floor", onTheFloor(), kOnTheFloor);
}

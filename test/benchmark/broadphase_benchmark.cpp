// SPDX-License-Identifier: BSD-3-Clause
// The cost of the broad phase against the number of bodies: balls and boxes that rain into a pen as wide as
// they need, and balls that hang in space with their centres in a plane x + y + z = 0, across the axis (1, 1,
// 1). Times are the least of the steps, since a busy machine only adds to them.
#include "base/random.h"
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace {

using namespace rbs;

constexpr int kSteps = 20;

BodyDef wall(const Vec3& size, const Vec3& p_W) {
  BodyDef def;
  def.shape = Box{size};
  def.kind = BodyKind::Static;
  def.pose.p_WB = p_W;
  return def;
}

SceneDef rain(int n) {
  constexpr double kPitch = 0.8;
  constexpr int kLayers = 10;
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n) / kLayers)));
  const double half = 0.5 * kPitch * side + 0.3;
  SceneDef scene;
  BodyDef floor;
  floor.shape = Plane{};
  floor.kind = BodyKind::Static;
  scene.bodies.push_back(floor);
  for (const double sign : {-1.0, 1.0}) {
    scene.bodies.push_back(wall({0.2, 2.0 * half, 2.0}, {sign * (half + 0.1), 0.0, 1.0}));
    scene.bodies.push_back(wall({2.0 * half, 0.2, 2.0}, {0.0, sign * (half + 0.1), 1.0}));
  }
  SplitMix64 random(7);
  for (int k = 0; k < n; ++k) {
    const double size = random.uniform(0.19, 0.4);
    BodyDef def;
    def.shape = k % 2 ? Shape(Sphere{0.5 * size}) : Shape(Box{Vec3::Constant(size)});
    const Vec3 place(k % side - 0.5 * (side - 1), k / side % side - 0.5 * (side - 1), k / side / side + 1);
    def.pose.p_WB = kPitch * place;
    for (int axis = 0; axis < 3; ++axis) def.pose.p_WB[axis] += random.uniform(-0.04, 0.04);
    def.pose.q_WB = randomAttitude(random);
    scene.bodies.push_back(def);
  }
  return scene;
}

SceneDef acrossTheAxis(int n) {
  const double reach = 0.5 * std::sqrt(static_cast<double>(n));
  SceneDef scene;
  scene.gravity.setZero();
  SplitMix64 random(7);
  for (int k = 0; k < n; ++k) {
    BodyDef def;
    def.shape = Sphere{0.15};
    for (int axis = 0; axis < 3; ++axis) def.pose.p_WB[axis] = random.uniform(-reach, reach);
    def.pose.p_WB -= Vec3::Constant(def.pose.p_WB.sum() / 3.0);
    scene.bodies.push_back(def);
  }
  return scene;
}

void measure(const char* name, const SceneDef& scene, int n, int warm_up) {
  World world(scene);
  for (int k = 0; k < warm_up; ++k) world.step();
  double broad_phase = std::numeric_limits<double>::infinity(), step = broad_phase;
  StepReport report;
  for (int k = 0; k < kSteps; ++k) {
    report = world.step();
    step = std::min(step, report.seconds);
    for (const StageInfo& stage : world.pipeline())
      if (stage.name == "broadphase.pairs") broad_phase = std::min(broad_phase, stage.seconds);
  }
  std::printf("| %s | %d | %u | %llu | %lld | %.3f | %.2f |\n", name, n, report.pairs,
              static_cast<unsigned long long>(report.overlap_tests), n * (n - 1LL) / 2, 1e3 * broad_phase,
              1e3 * step);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::printf("| scene | bodies | pairs | tests | tests of all pairs | broad phase, ms | step, ms |\n");
  std::printf("|---|--:|--:|--:|--:|--:|--:|\n");
  constexpr int kCounts[] = {100, 300, 1000, 3000, 10000};
  for (const int n : kCounts) measure("mixed rain", rain(n), n, 90);
  for (const int n : kCounts) measure("all centres in one plane", acrossTheAxis(n), n, 2);
}
